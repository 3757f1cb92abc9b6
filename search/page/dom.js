/**
 * DOM helpers. Text is inserted as text nodes only, so that text from files cannot become markup.
 */

const SVG = "http://www.w3.org/2000/svg";

/**
 * @param {string} tag
 * @param {Record<string, any>} [attributes] `on…` are listeners, booleans set or omit an attribute, others are set as strings
 * @param {...(Node | string | number | null | undefined)} children
 * @returns {HTMLElement}
 */
export function el(tag, attributes = {}, ...children) {
  return /** @type {HTMLElement} */ (filled(document.createElement(tag), attributes, children));
}

/** The same for SVG. @returns {SVGElement} */
export function svg(tag, attributes = {}, ...children) {
  return /** @type {SVGElement} */ (filled(document.createElementNS(SVG, tag), attributes, children));
}

/** @param {Element} node @param {Record<string, any>} attributes @param {any[]} children */
function filled(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value === true) node.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) node.setAttribute(name, String(value));
  }
  node.append(...children.filter((child) => child !== null && child !== undefined).map((child) => (child instanceof Node ? child : String(child))));
  return node;
}

/** `document.getElementById`. @param {string} id @returns {any} */
export const byId = (id) => document.getElementById(id);

/** Load a style sheet. @param {string} href @returns {Promise<void>} */
export const styled = (href) => new Promise((done, fail) => document.head.append(el("link", { rel: "stylesheet", href, onload: () => done(), onerror: fail })));

/** A duration as text: `4.2 s`, `3:07`, `1:27:40`. @param {number} seconds */
export function clock(seconds) {
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  return [...(hours ? [hours, String(minutes).padStart(2, "0")] : [minutes]), String(whole % 60).padStart(2, "0")].join(":");
}

/** @param {number} value @param {number} low @param {number} high */
export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/** The strength of a hit as bars and a word, so that it does not depend on colour. @param {string} strength */
export function strengthMark(strength) {
  if (!strength) return null;
  const level = { strong: 3, plausible: 2, weak: 1 }[strength] ?? 1;
  const bars = [0, 1, 2].map((i) =>
    svg("rect", { x: i * 5, y: 8 - i * 4, width: 3.5, height: 4 + i * 4, rx: 1, class: i < level ? "on" : "off" }),
  );
  return el("span", { class: `strength ${strength}` }, svg("svg", { viewBox: "0 0 14 12", "aria-hidden": "true" }, ...bars), strength);
}
