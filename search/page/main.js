/**
 * The entry point: the URL fragment is the state, and every part of the page renders it.
 */

import * as api from "./api.js";
import { onFiles } from "./drop.js";
import { byId, clock, el, styled } from "./dom.js";
import { listenToFacets, showFacets } from "./facets.js";
import { Grid } from "./grid.js";
import { Plane } from "./map.js";
import { listenToQuestion, showQuestion } from "./question.js";
import * as recent from "./recent.js";
import { Results } from "./results.js";
import { listenToShortcuts } from "./shortcuts.js";
import { areStacked, readStacks } from "./stacks.js";
import { Stage } from "./stage.js";
import { CLOSED, close, entry, link, read, subscribe } from "./state.js";
import { changeTheme, onTheme } from "./theme.js";
import { listenToTray } from "./tray.js";
import { Viewer } from "./viewer.js";

const POLL = 15_000; // milliseconds between checks whether the library has changed

let playing = !matchMedia("(prefers-reduced-motion: reduce)").matches;
const isPlaying = () => playing;
const stage = makeStage();
const grid = new Grid(stage, byId("grid"), isPlaying);
const results = new Results(grid);
const viewer = new Viewer(stage, isPlaying, () => grid.hits);
const plane = new Plane(stage);
/** The editor of time lines, once it has been opened. @type {import("./composer.js").Composer | null} */
let composer = null;
const VIEWS = ["viewer", "map", "composer", "results"];

function makeStage() {
  try {
    return new Stage(byId("canvas"));
  } catch {
    byId("library").textContent = "This browser has no WebGL: figures are not shown, everything else works.";
    return null;
  }
}

/** Where the user was in each history entry: how far down, at which card, of how many. @type {Map<number, {y: number, card: number, count: number}>} */
const places = new Map();
let here = entry();
const remember = () => places.set(here, { y: scrollY, card: grid.last, count: results.offset });

/** @param {import("./state.js").State} state @param {boolean} back whether the browser went back or forward */
async function show(state, back = false) {
  const where = state.clip ? "viewer" : state.view === "map" ? "map" : state.view === "compose" ? "composer" : "results";
  const from = VIEWS.find((id) => !byId(id).hidden);
  if (from === "results") remember();
  const isNew = entry() !== here;
  const place = back ? places.get(entry()) : undefined;
  here = entry();
  for (const id of VIEWS) byId(id).hidden = id !== where || (id === "composer" && !composer);
  document.body.classList.toggle("viewing", where === "viewer" || where === "composer");
  showQuestion(state);
  recent.remember(state.like ? "" : state.q);
  byId("to-grid").href = link({ ...CLOSED, view: "" });
  byId("to-map").href = link({ ...CLOSED, view: "map" });
  byId("to-compose").href = link({ ...CLOSED, view: "compose" });
  for (const [id, current] of [["to-grid", where === "results"], ["to-map", where === "map"], ["to-compose", where === "composer"]]) byId(id).toggleAttribute("aria-current", current);
  if (where !== "viewer") {
    viewer.close();
    document.title = state.q ? `${state.q} – motionseek` : "motionseek";
  }
  if (stage) stage.dirty = true;
  if (where === "viewer") viewer.show(state);
  if (where === "map") plane.show(state, from === "viewer");
  if (where === "composer") compose();
  else composer?.close();
  if (where !== "results") return isNew && !back && scrollTo(0, 0);
  const shown = results.show(state, place?.count);
  if (isNew && !back && from !== "results") scrollTo(0, 0);
  if (!place) return from === "viewer" && byId("main").focus({ preventScroll: true });
  const asked = here;
  await shown;
  if (here !== asked) return;
  scrollTo(0, place.y);
  if (from === "viewer") grid.focus(place.card);
}

byId("skip").addEventListener("click", (/** @type {Event} */ event) => {
  event.preventDefault();
  byId("main").focus();
});
byId("back").addEventListener("click", close);
byId("play-all").addEventListener("click", togglePlaying);
function togglePlaying() {
  playing = !playing;
  grid.refresh();
  showPlaying();
}
function showPlaying() {
  byId("play-all").textContent = playing ? "Pause all" : "Play all";
}

onTheme(() => {
  stage?.repaint();
  viewer.repaint();
  plane.refresh();
});
byId("theme").addEventListener("click", changeTheme);
byId("help-button").addEventListener("click", () => byId("help").showModal());
onFiles();
listenToQuestion(() => grid.focus(0));
/** Show the editor; a first visit does not load it. */
async function compose() {
  if (!composer) {
    const [{ Composer }] = await Promise.all([import("./composer.js"), styled("compose.css")]);
    composer ??= new Composer(stage, isPlaying);
  }
  if (read().view !== "compose" || read().clip) return;
  byId("composer").hidden = false;
  composer.show(read());
}

listenToShortcuts({ viewer, grid, togglePlaying: () => (read().view === "compose" ? composer?.toggle() : togglePlaying()) });

/** Show the size and the filters of the library, again when it has changed. */
let generation = -1;
async function updateLibrary() {
  const stats = await api.stats().catch(() => null);
  if (!stats || stats.generation === generation) return;
  const changed = generation >= 0;
  generation = stats.generation;
  if (stage) byId("library").textContent = `${stats.clips.toLocaleString("en")} clip${stats.clips === 1 ? "" : "s"}${stats.clips ? ` · ${clock(stats.seconds)}` : ""}`;
  for (const [name, counts] of [["format", stats.formats], ["rig", stats.rigs]]) {
    const select = byId("filters").elements[name];
    select.replaceChildren(select.options[0], ...Object.keys(counts).map((value) => el("option", { value }, `${value} (${counts[value]})`)));
    select.value = read()[name];
  }
  readStacks(() => areStacked(grid.hits) && askAgain());
  if (!changed) return;
  showFacets(read(), true);
  plane.refresh({ again: true });
  if (read().view === "map" || !grid.cards.length) { results.asked = ""; show(read()); } // prettier-ignore
}
setInterval(() => document.visibilityState === "visible" && updateLibrary(), POLL);

/** Ask the question of now again, as its answer has changed. */
function askAgain() {
  results.asked = "";
  if (!byId("results").hidden) results.show(read(), results.offset);
}

listenToFacets();
listenToTray(() => {
  askAgain();
  showFacets(read(), true);
});
recent.show();
subscribe(show);
showPlaying();
show(read());
updateLibrary();
