/**
 * The state of the page, kept in the URL fragment: every view has a link, and the back button works.
 */

import { clamp } from "./dom.js";

const MOST = 1_000_000; // clips of a selection

/**
 * @typedef {object} State
 * @property {string} q            the sentence
 * @property {string} moments      "1": ask for moments rather than clips
 * @property {string} min          filters: minimum duration in seconds
 * @property {string} max          maximum duration in seconds
 * @property {string} path         a glob
 * @property {string} format
 * @property {string} rig          the name of a rig
 * @property {string} captioned    "true" or "false"
 * @property {string} starred      "true"
 * @property {string} tag          the name of a tag
 * @property {string} collection
 * @property {string} strength     the least strength of a hit
 * @property {string} sort         the order: "name", "longest", "shortest", "newest"; "" the best or most varied first
 * @property {string} like         a clip: show similar clips, of those that fit the sentence where there is one…
 * @property {string} from         …or clips similar to this span of it
 * @property {string} to
 * @property {string} ids          clips that were selected: numbers, ranges and keys, separated by commas
 * @property {string} view         "map", "compose" or ""
 * @property {string} line         sentences to compose: JSON, a row [text, start, end, parts, clip, at] each
 * @property {string} clip         the clip that is open
 * @property {string} a            in point, seconds
 * @property {string} b            out point
 * @property {string} with         a clip beside it, to compare
 * @property {string} c            the time of that clip that coincides with the in point, seconds
 * @property {string[]} ask        further sentences asked of the open clip
 */

const NAMES = /** @type {const} */ (["q", "moments", "min", "max", "path", "format", "rig", "captioned", "starred", "tag", "collection", "strength", "sort", "like", "from", "to", "ids", "view", "clip", "a", "b", "with", "c", "line"]);

/** @returns {State} */
export function read(hash = location.hash) {
  const given = new URLSearchParams(hash.replace(/^#/, ""));
  const state = Object.fromEntries(NAMES.map((name) => [name, given.get(name) ?? ""]));
  return /** @type {State} */ ({ ...state, ask: given.getAll("ask").slice(0, 8) });
}

/** The fragment of the current state with changes. @param {Partial<State>} changes */
export function link(changes) {
  const state = { ...read(), ...changes };
  const given = new URLSearchParams();
  for (const name of NAMES) if (state[name]) given.set(name, state[name]);
  for (const sentence of state.ask) given.append("ask", sentence);
  return `#${given}`;
}

/** The clips of `ids`: `3,7-9` is 3, 7, 8, 9. @param {string} ids @returns {string[]} */
export const clipsOf = (ids) =>
  ids.split(",").filter(Boolean).flatMap((part) => {
    const [, first, last] = part.match(/^(\d+)-(\d+)$/) ?? [];
    return first ? Array.from({ length: clamp(Number(last) - Number(first) + 1, 0, MOST) }, (_, i) => String(Number(first) + i)) : [part];
  }).slice(0, MOST); // prettier-ignore

/** Numbers of clips as `ids`, neighbours as ranges. @param {Iterable<number>} clips */
export function idsOf(clips) {
  /** @type {[number, number][]} */
  const ranges = [];
  for (const clip of [...clips].sort((a, b) => a - b)) {
    const range = ranges.at(-1);
    if (range && clip === range[1] + 1) range[1] = clip;
    else ranges.push([clip, clip]);
  }
  return ranges.map(([first, last]) => (first === last ? `${first}` : `${first}-${last}`)).join(",");
}

/** The changes that close an open clip. */
export const CLOSED = { clip: "", a: "", b: "", with: "", c: "", ask: [] };

/** @type {((state: State, back: boolean) => void)[]} */
const listeners = [];

/** @param {(state: State, back: boolean) => void} listener called with every new state; `back`: by the browser's back or forward */
export function subscribe(listener) {
  listeners.push(listener);
}

const tell = (back = false) => listeners.forEach((listener) => listener(read(), back));

/** Change the state; `quietly` adds no history entry. @param {Partial<State>} changes */
export function go(changes, { quietly = false } = {}) {
  const address = link(changes);
  if (address === (location.hash || "#")) return;
  if (quietly) history.replaceState(history.state, "", address);
  else history.pushState({ entry: crypto.getRandomValues(new Uint32Array(1))[0], below: link({}) }, "", address);
  tell();
}

/** Close the open clip: one entry back where it was opened from the view below it, else in place. */
export function close() {
  if (history.state?.below === link(CLOSED)) history.back();
  else go(CLOSED, { quietly: true });
}

/** Update the fragment for a change that is shown already. @param {Partial<State>} changes */
export const note = (changes) => history.replaceState(history.state, "", link(changes));

/** What names the present history entry. @returns {number} */
export const entry = () => history.state?.entry ?? 0;

history.scrollRestoration = "manual"; // results come after the entry: main.js restores the place once they are there
addEventListener("popstate", () => tell(true));
document.addEventListener("click", (event) => {
  const anchor = /** @type {Element} */ (event.target).closest?.("a[href^='#']:not([data-native])");
  if (!anchor || event.defaultPrevented || event.button || event.ctrlKey || event.metaKey || event.shiftKey || event.altKey) return;
  event.preventDefault();
  go(read(/** @type {HTMLAnchorElement} */ (anchor).hash));
}); // a link adds an entry that knows what is below it

/** The filters as the server takes them. @param {State} state */
export const filters = ({ min, max, path, format, rig, captioned, starred, tag, collection }) => ({
  min_duration: min, max_duration: max, path, format, rig, captioned, starred, tag, collection,
}); // prettier-ignore

/** The clip that hits shall be like, and the span of it. @param {State} state */
export const likeness = ({ like, from, to }) => (like ? { like, start: from, end: to } : {});

/** The filters of a question. @param {State} state */
export const asked = (state) => ({ ...filters(state), min_strength: state.strength });
