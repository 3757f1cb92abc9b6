/**
 * Recent questions: kept in this browser, offered below the search box and as suggestions on the first screen.
 */

import { byId, el } from "./dom.js";
import { link } from "./state.js";

const NAME = "recent-questions";
const MOST = 12;
const SHOWN = 4; // on the first screen
const SETTLED = 1500; // milliseconds after which a question was not just typed through

let settling = 0;

/** @returns {string[]} the newest first */
export function recent() {
  try {
    const held = JSON.parse(localStorage.getItem(NAME) ?? "[]");
    return Array.isArray(held) ? held.filter((q) => typeof q === "string" && q).slice(0, MOST) : [];
  } catch {
    return [];
  }
}

/** Keep a question once it stands for a while. @param {string} q */
export function remember(q) {
  clearTimeout(settling);
  if (!q) return;
  settling = setTimeout(() => {
    localStorage.setItem(NAME, JSON.stringify([q, ...recent().filter((other) => other !== q)].slice(0, MOST)));
    show();
  }, SETTLED);
}

/** Show them. */
export function show() {
  const questions = recent();
  byId("recent").replaceChildren(...questions.map((value) => el("option", { value })));
  const forget = el("button", { type: "button", class: "plain", onclick: () => { localStorage.removeItem(NAME); show(); } }, "Forget"); // prettier-ignore
  byId("recent-chips").hidden = !questions.length;
  byId("recent-chips").replaceChildren(
    el("span", { class: "quiet" }, "Recent"),
    ...questions.slice(0, SHOWN).map((q) => el("a", { class: "chip", href: link({ q, view: "", clip: "" }) }, q)),
    forget,
  );
}
