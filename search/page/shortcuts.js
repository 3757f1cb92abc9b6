/**
 * The keyboard shortcuts of the page.
 */

import * as api from "./api.js";
import { byId, el } from "./dom.js";
import { listen } from "./keys.js";
import { CLOSED, close, go, read } from "./state.js";
import { changeTheme } from "./theme.js";

/** @param {{viewer: import("./viewer.js").Viewer, grid: import("./grid.js").Grid, togglePlaying: () => void}} parts */
export function listenToShortcuts({ viewer, grid, togglePlaying }) {
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
  const back = () => viewer.stepFrames(-1);
  const on = () => viewer.stepFrames(1);
  const zoom = (/** @type {number} */ factor) => () => viewer.timeline.zoomBy(factor);
  listen([
    { key: "/", says: "focus the search box", act: () => byId("q").select() },
    { key: " ", shown: "Space", says: "play or pause", viewer: true, act: () => viewer.toggle() },
    { key: " ", shown: "Space", says: "play or pause", viewer: false, act: togglePlaying },
    { key: "ArrowLeft", shown: ", .", says: "previous or next frame", viewer: true, act: back },
    { key: "ArrowRight", shown: ", .", says: "previous or next frame", viewer: true, act: on },
    { key: ",", says: "previous or next frame", shown: ", .", viewer: true, act: back },
    { key: ".", says: "previous or next frame", shown: ", .", viewer: true, act: on },
    { key: "[", shown: "[ ]", says: "set the in point, the out point", viewer: true, act: () => viewer.markHere("in") },
    { key: "]", shown: "[ ]", says: "set the in point, the out point", viewer: true, act: () => viewer.markHere("out") },
    { key: "+", shown: "+ - 0", says: "zoom the time line", viewer: true, act: zoom(2) },
    { key: "=", shown: "+ - 0", says: "zoom the time line", viewer: true, act: zoom(2) },
    { key: "-", shown: "+ - 0", says: "zoom the time line", viewer: true, act: zoom(1 / 2) },
    { key: "0", shown: "+ - 0", says: "zoom the time line", viewer: true, act: zoom(0) },
    { key: "l", says: "loop", viewer: true, act: () => byId("loop").click() },
    { key: "p", shown: "p g", says: "path, feet", viewer: true, act: () => byId("path").click() },
    { key: "g", shown: "p g", says: "path, feet", viewer: true, act: () => byId("feet").click() },
    { key: "c", says: "compare", viewer: true, act: () => byId("compare").click() },
    { key: "t", says: "trail", viewer: true, act: () => byId("trail").click() },
    { key: "a", says: "search the take for another sentence", viewer: true, act: () => byId("track").focus() },
    { key: "e", says: "export the cut", act: save },
    { key: "s", says: "more like this", act: similar },
    { key: "m", says: "map", act: () => go({ ...CLOSED, view: read().view === "map" ? "" : "map" }) },
    { key: "o", says: "compose", act: () => go({ ...CLOSED, view: read().view === "compose" ? "" : "compose" }) },
    { key: "f", says: "filters", act: () => byId("filters-button").click() },
    { key: "d", says: "light or dark", act: changeTheme },
    { key: "Escape", shown: "Esc", says: "back", viewer: true, act: close },
    { key: "?", says: "this help", act: () => byId("help").showModal() },
  ], () => Boolean(read().clip)); // prettier-ignore
}
