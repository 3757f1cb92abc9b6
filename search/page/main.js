/**
 * The entry point: the URL fragment is the state, and every part of the page renders it.
 */

import * as api from "./api.js";
import { onFiles } from "./drop.js";
import { byId, clock, el } from "./dom.js";
import { Grid } from "./grid.js";
import { listen } from "./keys.js";
import { Plane } from "./map.js";
import { Results } from "./results.js";
import { Stage } from "./stage.js";
import { CLOSED, filters, go, link, read, subscribe } from "./state.js";
import { Viewer } from "./viewer.js";

const DEBOUNCE = 220; // milliseconds without typing before a search
const POLL = 15_000; // milliseconds between checks whether the library has changed

const dark = matchMedia("(prefers-color-scheme: dark)");
const chosen = localStorage.getItem("theme");
if (chosen) document.documentElement.dataset.theme = chosen;

let waiting = 0; // the debounce timer of the search box
let playing = !matchMedia("(prefers-reduced-motion: reduce)").matches;
const isPlaying = () => playing;
const stage = makeStage();
const grid = new Grid(stage, byId("grid"), isPlaying);
const results = new Results(grid);
const viewer = new Viewer(stage, isPlaying);
const plane = new Plane(stage);

function makeStage() {
  try {
    return new Stage(byId("canvas"));
  } catch {
    byId("library").textContent = "This browser has no WebGL: figures are not shown, everything else works.";
    return null;
  }
}

/** @param {import("./state.js").State} state */
function show(state) {
  const where = state.clip ? "viewer" : state.view === "map" ? "map" : "results";
  const moved = byId(where).hidden;
  for (const id of ["viewer", "map", "results"]) byId(id).hidden = id !== where;
  if (!waiting && byId("q").value.trim() !== state.q) byId("q").value = state.q;
  byId("moments").checked = Boolean(state.moments);
  for (const input of byId("filters").elements) if (input.name) input.value = state[input.name];
  const set = Object.values(filters(state)).filter(Boolean).length;
  byId("filter-count").textContent = set ? `(${set})` : "";
  byId("to-grid").href = link({ ...CLOSED, view: "" });
  byId("to-map").href = link({ ...CLOSED, view: "map" });
  byId("back").href = link(CLOSED);
  for (const [id, here] of [["to-grid", where === "results"], ["to-map", where === "map"]]) byId(id).toggleAttribute("aria-current", here);
  if (where !== "viewer") {
    viewer.close();
    document.title = state.q ? `${state.q} – motionseek` : "motionseek";
  }
  if (where === "viewer") viewer.show(state);
  if (where === "map") plane.show(state);
  if (where === "results") results.show(state);
  if (where === "viewer" && moved) scrollTo(0, 0);
  if (stage) stage.dirty = true;
}

/** A new search closes an open clip and drops a similarity query or a selection. */
const ask = (/** @type {Partial<import("./state.js").State>} */ changes, quietly) =>
  go({ ...CLOSED, like: "", from: "", to: "", ids: "", ...changes }, { quietly });

/** Search for the text in the search box. */
function searchTyped() {
  clearTimeout(waiting);
  waiting = 0;
  ask({ q: byId("q").value.trim() }, Boolean(read().q));
}
byId("q").addEventListener("input", () => {
  clearTimeout(waiting);
  waiting = setTimeout(searchTyped, DEBOUNCE);
});
byId("ask").addEventListener("submit", (/** @type {Event} */ event) => {
  event.preventDefault();
  searchTyped();
});
byId("q").addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
  if (event.key !== "ArrowDown" || !grid.cards.length) return;
  event.preventDefault();
  grid.focus();
});
byId("moments").addEventListener("change", () => go({ ...CLOSED, moments: byId("moments").checked ? "1" : "" }));
byId("home").addEventListener("click", () => (byId("q").value = ""));
let narrowing = 0;
byId("filters").addEventListener("submit", (/** @type {Event} */ event) => event.preventDefault());
byId("filters").addEventListener("input", () => {
  clearTimeout(narrowing);
  narrowing = setTimeout(() => go(Object.fromEntries(new FormData(byId("filters"))), { quietly: true }), DEBOUNCE);
});
byId("filters").addEventListener("reset", () => go({ min: "", max: "", path: "", format: "", rig: "", captioned: "" }));
byId("filters-button").addEventListener("click", () => {
  byId("filters").hidden = !byId("filters").hidden;
  byId("filters-button").setAttribute("aria-expanded", String(!byId("filters").hidden));
});

byId("play-all").addEventListener("click", togglePlaying);
function togglePlaying() {
  playing = !playing;
  grid.refresh();
  showPlaying();
}
function showPlaying() {
  byId("play-all").setAttribute("aria-pressed", String(playing));
  byId("play-all").textContent = playing ? "Pause all" : "Play all";
}

function repaint() {
  stage?.repaint();
  plane.refresh();
}
function changeTheme() {
  const now = document.documentElement.dataset.theme ?? (dark.matches ? "dark" : "light");
  const next = now === "dark" ? "light" : "dark";
  localStorage.setItem("theme", next);
  document.documentElement.dataset.theme = next;
  repaint();
}
byId("theme").addEventListener("click", changeTheme);
dark.addEventListener("change", repaint);

onFiles(async (file) => {
  byId("status").textContent = byId("viewer-status").textContent = `Reading ${file.name}…`;
  try {
    const { clip } = await api.upload(file);
    go({ ...CLOSED, q: "", clip });
  } catch (error) {
    byId("status").textContent = byId("viewer-status").textContent = `${file.name}: ${/** @type {Error} */ (error).message}`;
  }
});

const help = () => byId("help").showModal();
byId("help-button").addEventListener("click", help);

/** Clips similar to the cut of the open clip, or to the focused card. */
function similar() {
  const hit = grid.focused;
  if (read().clip) byId("similar").click();
  else if (hit) go({ q: "", ids: "", like: String(hit.clip), from: hit.start.toFixed(2), to: hit.end.toFixed(2) });
}

/** Download the cut of the open clip, or the span of the focused card. */
function save() {
  const hit = grid.focused;
  if (read().clip) byId("export").click();
  else if (hit) el("a", { href: api.exportAddress(hit.clip, hit.start, hit.end, "bvh"), download: true }).click();
}

listen([
  { key: "/", says: "focus the search box", act: () => byId("q").select() },
  { key: " ", shown: "Space", says: "play or pause", viewer: true, act: () => viewer.toggle() },
  { key: " ", shown: "Space", says: "play or pause", viewer: false, act: togglePlaying },
  { key: "ArrowLeft", shown: ", .", says: "previous or next frame", viewer: true, act: () => viewer.step(-0.05) },
  { key: "ArrowRight", shown: ", .", says: "previous or next frame", viewer: true, act: () => viewer.step(0.05) },
  { key: ",", says: "previous or next frame", shown: ", .", viewer: true, act: () => viewer.step(-0.05) },
  { key: ".", says: "previous or next frame", shown: ", .", viewer: true, act: () => viewer.step(0.05) },
  { key: "[", says: "set the in point", viewer: true, act: () => viewer.markHere("in") },
  { key: "]", says: "set the out point", viewer: true, act: () => viewer.markHere("out") },
  { key: "+", shown: "+ - 0", says: "zoom the time line", viewer: true, act: () => viewer.timeline.zoomBy(2) },
  { key: "=", shown: "+ - 0", says: "zoom the time line", viewer: true, act: () => viewer.timeline.zoomBy(2) },
  { key: "-", shown: "+ - 0", says: "zoom the time line", viewer: true, act: () => viewer.timeline.zoomBy(1 / 2) },
  { key: "0", shown: "+ - 0", says: "zoom the time line", viewer: true, act: () => viewer.timeline.zoomBy(0) },
  { key: "l", says: "loop", viewer: true, act: () => byId("loop").click() },
  { key: "t", says: "trail", viewer: true, act: () => byId("trail").click() },
  { key: "a", says: "search the take for another sentence", viewer: true, act: () => byId("track").focus() },
  { key: "e", says: "export the cut", act: save },
  { key: "s", says: "more like this", act: similar },
  { key: "m", says: "map", act: () => go({ ...CLOSED, view: read().view === "map" ? "" : "map" }) },
  { key: "f", says: "filters", act: () => byId("filters-button").click() },
  { key: "d", says: "light or dark", act: changeTheme },
  { key: "Escape", shown: "Esc", says: "back", viewer: true, act: () => go(CLOSED) },
  { key: "?", says: "this help", act: help },
], () => Boolean(read().clip)); // prettier-ignore

/** Show the size and the filters of the library, again when it has changed. */
let generation = -1;
async function updateLibrary() {
  const stats = await api.stats().catch(() => null);
  if (!stats || stats.generation === generation) return;
  const changed = generation >= 0;
  generation = stats.generation;
  if (stage) byId("library").textContent = `${stats.clips} clips · ${clock(stats.seconds)}`;
  for (const [name, counts] of [["format", stats.formats], ["rig", stats.rigs]]) {
    const select = byId("filters").elements[name];
    select.replaceChildren(select.options[0], ...Object.keys(counts).map((value) => el("option", { value }, `${value} (${counts[value]})`)));
    select.value = read()[name];
  }
  if (!changed) return;
  plane.refresh({ again: true });
  if (read().view === "map" || !grid.cards.length) { results.asked = ""; show(read()); } // prettier-ignore
}
setInterval(() => document.visibilityState === "visible" && updateLibrary(), POLL);

subscribe(show);
showPlaying();
show(read());
updateLibrary();
