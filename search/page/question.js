/**
 * The question: the search box, exact moments, and the filters. All of it goes into the state while the user types.
 */

import { byId } from "./dom.js";
import { showFacets } from "./facets.js";
import { CLOSED, asked, go, read } from "./state.js";

const DEBOUNCE = 100; // milliseconds without typing before a search
const SETTLE = 250; // before a filter that is being typed is applied
const NO_FILTERS = { min: "", max: "", path: "", format: "", rig: "", captioned: "", starred: "", tag: "", collection: "", strength: "" };

let waiting = 0; // the debounce timer of the search box
let narrowing = 0; // that of the filters

/** Show the question of a state; what is being typed stays. @param {import("./state.js").State} state */
export function showQuestion(state) {
  if (!waiting && byId("q").value.trim() !== state.q) byId("q").value = state.q;
  byId("moments").checked = Boolean(state.moments);
  if (!narrowing) for (const input of byId("filters").elements) if (input.name) input.value = state[input.name];
  const set = Object.values(asked(state)).filter(Boolean).length;
  byId("filter-count").textContent = set ? `(${set})` : "";
  showFacets(state);
}

/** Search for the text in the search box; a new question closes an open clip and drops likeness or a selection. */
function search() {
  clearTimeout(waiting);
  waiting = 0;
  const q = byId("q").value.trim();
  if (q === read().q && !read().clip) return;
  go({ ...CLOSED, like: "", from: "", to: "", ids: "", q, ...(read().view === "compose" ? { view: "" } : {}) }, { quietly: Boolean(read().q) && !read().clip });
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
