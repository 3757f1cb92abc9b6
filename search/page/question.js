/**
 * The question: the search box, exact moments, and the filters. All of it goes into the state while the user types.
 */

import * as api from "./api.js";
import { byId } from "./dom.js";
import { showFacets } from "./facets.js";
import { CLOSED, asked, go, read } from "./state.js";
import { parsed } from "./typed.js";

const DEBOUNCE = 100; // milliseconds without typing before a search
const SETTLE = 250; // before a filter that is being typed is applied
const NO_FILTERS = { min: "", max: "", path: "", format: "", rig: "", captioned: "", starred: "", tag: "", collection: "", strength: "" };

const EMPTY = byId("q").placeholder;
const LIKE = "but slower, with the left hand…"; // where it is asked beside a clip

/** Filters that stand in the search box. @type {Record<string, string>} */
let typed = {};
let waiting = 0; // the debounce timer of the search box
let narrowing = 0; // that of the filters

/** Show the question of a state; what is being typed stays. @param {import("./state.js").State} state */
export function showQuestion(state) {
  const inBox = parsed(byId("q").value);
  if (!waiting && (inBox.q !== state.q || Object.entries(inBox.given).some(([name, value]) => state[name] !== value))) byId("q").value = state.q;
  typed = parsed(byId("q").value).given;
  showLikeness(state);
  byId("moments").checked = Boolean(state.moments);
  if (!narrowing) for (const input of byId("filters").elements) if (input.name) input.value = state[input.name];
  const set = Object.values(asked(state)).filter(Boolean).length;
  byId("filter-count").textContent = set ? `(${set})` : "";
  showFacets(state);
}

/** Show the clip that the hits shall be like. @param {import("./state.js").State} state */
async function showLikeness({ like, from, to }) {
  byId("likeness").hidden = !like;
  byId("q").placeholder = like ? LIKE : EMPTY;
  if (!like) return;
  const name = await api.motion(like).then((info) => info.name, () => `#${like}`);
  if (read().like === like) byId("like-clip").textContent = from ? `${name}, ${(+from).toFixed(1)}–${(+to).toFixed(1)} s` : name;
}

/** Search for the text in the search box; a new question closes an open clip and drops a selection, and is asked beside a likeness. */
function search() {
  clearTimeout(waiting);
  waiting = 0;
  const { q, given } = parsed(byId("q").value);
  const narrowed = { ...Object.fromEntries(Object.keys(typed).map((name) => [name, ""])), ...given };
  const state = read();
  if (q === state.q && !state.clip && Object.entries(narrowed).every(([name, value]) => state[name] === value)) return;
  go({ ...CLOSED, ids: "", ...narrowed, q, ...(read().view === "compose" ? { view: "" } : {}) }, { quietly: Boolean(read().q) && !read().clip });
}

function narrow() {
  clearTimeout(narrowing);
  narrowing = 0;
  go(Object.fromEntries(new FormData(byId("filters"))), { quietly: true });
}

/** Take what the user types. @param {() => void} leave called to move from the box to what was found */
export function listenToQuestion(leave) {
  byId("q").addEventListener("input", () => {
    clearTimeout(waiting);
    waiting = setTimeout(search, DEBOUNCE);
  });
  byId("ask").addEventListener("submit", (/** @type {Event} */ event) => {
    event.preventDefault();
    search();
  });
  byId("q").addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
    if (event.key !== "ArrowDown") return;
    event.preventDefault();
    leave();
  });
  byId("moments").addEventListener("change", () => go({ ...CLOSED, moments: byId("moments").checked ? "1" : "" }, { quietly: !read().clip }));
  byId("like-off").addEventListener("click", () => go({ ...CLOSED, like: "", from: "", to: "" }));
  byId("home").addEventListener("click", () => (byId("q").value = ""));
  byId("filters").addEventListener("submit", (/** @type {Event} */ event) => {
    event.preventDefault();
    narrow();
  });
  byId("filters").addEventListener("input", () => {
    clearTimeout(narrowing);
    narrowing = setTimeout(narrow, SETTLE);
  });
  byId("filters").addEventListener("reset", () => go(NO_FILTERS, { quietly: true }));
  byId("filters-button").addEventListener("click", () => {
    byId("filters").hidden = !byId("filters").hidden;
    byId("filters-button").setAttribute("aria-expanded", String(!byId("filters").hidden));
  });
}
