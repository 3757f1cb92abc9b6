/**
 * The tray: clips that were selected, to download as one archive, to copy their paths, or to star, tag and collect.
 * It is kept in this browser; stars, tags and collections are the library's, where the server may write it.
 */

import * as api from "./api.js";
import { byId, el } from "./dom.js";
import { CLOSED, go } from "./state.js";

const NAME = "tray";
const MOST = 200; // clips of an archive
const FORMATS = ["bvh", "glb", "npz", "npy"];

/** @typedef {{clip: number | string, start: number | null, end: number | null, path: string}} Item */
/** @type {Map<string, Item>} */
const items = read();
/** Whether the server may write marks. */
let edit = false;
/** @type {{tags: Record<string, number>, collections: Record<string, number>}} */
let names = { tags: {}, collections: {} };
let changed = () => {};

/** @returns {Map<string, Item>} */
function read() {
  try {
    return new Map(JSON.parse(localStorage.getItem(NAME) ?? "[]"));
  } catch {
    return new Map();
  }
}

const isWhole = (hit) => hit.end - hit.start >= hit.duration - 0.05;
/** @param {import("./api.js").Hit} hit @returns {Item} */
const itemOf = (hit) => ({ clip: hit.clip, start: isWhole(hit) ? null : +hit.start.toFixed(2), end: isWhole(hit) ? null : +hit.end.toFixed(2), path: hit.path });
/** @param {Item} item */
const keyOf = ({ clip, start, end }) => (start === null ? String(clip) : `${clip}:${start}:${end}`);
const isInLibrary = ({ clip }) => typeof clip === "number";

/** Read what the library has, and show the tray. @param {() => void} whenChanged called when marks have changed */
export async function listenToTray(whenChanged) {
  changed = whenChanged;
  byId("tray").replaceChildren(
    el("strong", { id: "tray-count" }),
    el("button", { type: "button", id: "tray-show" , onclick: () => go({ ...CLOSED, view: "", q: "", like: "", from: "", to: "", ids: [...new Set([...items.values()].map(({ clip }) => clip))].join(",") }) }, "Show"),
    el("span", { class: "export" },
      el("a", { id: "tray-download", class: "button accent", download: "motions.zip", href: "#", "data-native": true }, "Download"),
      el("label", {}, el("span", { class: "hidden" }, "Format of the archive"), el("select", { id: "tray-format", onchange: show }, ...FORMATS.map((name) => el("option", {}, name))))),
    el("button", { type: "button", id: "tray-compare", title: "Show two of them side by side, in step", onclick: compare }, "Compare"),
    el("button", { type: "button", id: "tray-copy", onclick: copyPaths }, "Copy paths"),
    el("span", { id: "tray-marks", hidden: true },
      el("button", { type: "button", id: "tray-star", onclick: () => change({ star: true }) }, "★ Star"),
      namer("tag", "Tag", (name) => change({ tags: [name] })),
      namer("collect", "Collect", (name) => change({ collections: [name] }))),
    el("button", { type: "button", id: "tray-clear", onclick: clear }, "Clear"),
    el("span", { id: "tray-status", role: "status", "aria-live": "polite", class: "quiet" }),
  ); // prettier-ignore
  show();
  await readNames();
}

async function readNames() {
  const found = await api.marks().catch(() => null);
  if (!found) return;
  ({ edit } = found);
  names = found;
  byId("tray-marks").hidden = !edit;
  document.body.classList.toggle("edit", edit);
  for (const [id, of] of [["tag-names", names.tags], ["collect-names", names.collections]]) byId(id).replaceChildren(...Object.keys(of).map((value) => el("option", { value })));
}

/** A box for the name of a tag or collection. */
function namer(name, label, act) {
  const input = /** @type {HTMLInputElement} */ (el("input", { type: "text", id: `tray-${name}`, list: `${name}-names`, maxlength: 100, placeholder: label, "aria-label": `${label} the selected clips`, autocomplete: "off" }));
  const submit = (event) => {
    event.preventDefault();
    if (input.value.trim()) act(input.value.trim());
    input.value = "";
  };
  return el("form", { onsubmit: submit }, input, el("datalist", { id: `${name}-names` }), el("button", { type: "submit" }, label));
}

/** Change the marks of the selected clips. */
async function change(marks) {
  const clips = [...new Set([...items.values()].filter(isInLibrary).map(({ clip }) => clip))];
  if (!clips.length) return told("None of them is in the library: index their folder first.");
  try {
    await api.changeMarks({ clips, ...marks });
    told(marks.star ? `Starred ${clips.length}` : `${marks.tags ? "Tagged" : "Collected"} ${clips.length}`);
    await readNames();
    changed();
  } catch (error) {
    told(/** @type {Error} */ (error).message);
  }
}

/** The selected clips, each once. @returns {Item[]} */
export const selected = () => [...new Map([...items.values()].reverse().map((item) => [item.clip, item])).values()].reverse();

/** Open the first of them, with the second beside it. */
function compare() {
  const [first, second] = selected();
  const [a, b, c] = [first.start, first.end, second.start].map((time) => String(time ?? ""));
  go({ ...CLOSED, clip: String(first.clip), a, b, with: String(second.clip), c });
}

const told = (text) => (byId("tray-status").textContent = text);

async function copyPaths() {
  const text = [...new Set([...items.values()].map(({ path }) => path))].join("\n");
  try {
    await navigator.clipboard.writeText(text);
    told(`Copied ${items.size === 1 ? "the path" : `${text.split("\n").length} paths`}`);
  } catch {
    told("The browser does not let this page copy.");
  }
}

function clear() {
  items.clear();
  keep();
  for (const box of document.querySelectorAll("#grid .pick")) /** @type {HTMLInputElement} */ (box).checked = false;
}

function keep() {
  localStorage.setItem(NAME, JSON.stringify([...items]));
  show();
}

function show() {
  byId("tray").hidden = !items.size;
  document.body.classList.toggle("with-tray", items.size > 0);
  byId("tray-count").textContent = `${items.size} selected`;
  byId("tray-compare").hidden = selected().length < 2;
  const clips = [...items.keys()].slice(0, MOST);
  const link = byId("tray-download");
  link.href = clips.length ? api.archiveAddress(clips, byId("tray-format").value) : "#";
  link.textContent = items.size > MOST ? `Download the first ${MOST}` : "Download";
  if (items.size) told("");
}

/** What is beside a card or an open clip: to select it, to star it, and to drag it out. @param {import("./api.js").Hit} hit */
export function tools(hit) {
  const item = itemOf(hit);
  const key = keyOf(item);
  const name = hit.path.split("/").pop();
  const pick = /** @type {HTMLInputElement} */ (el("input", { type: "checkbox", class: "pick", title: "Select", "aria-label": `Select ${name}`, checked: items.has(key), onchange: () => { pick.checked ? items.set(key, item) : items.delete(key); keep(); } })); // prettier-ignore
  const star = el("button", { type: "button", class: "star", "aria-pressed": String(Boolean(hit.starred)), "aria-label": `Star ${name}`, title: "Star", onclick: () => toggle(star, hit) }, "★");
  const address = api.exportAddress(hit.clip, item.start, item.end, "bvh");
  const save = el("a", { class: "save", href: address, download: true, draggable: "true", title: "Download as .bvh, or drag it out", "aria-label": `Download ${name}`, "data-native": true, ondragstart: (event) => dragged(event, address, name) }, "↓");
  return el("div", { class: "tools" }, save, isInLibrary(item) ? star : null, pick);
}

/** @param {DragEvent} event Chromium writes the file where it is dropped, others give its address. */
function dragged(event, address, name) {
  const url = new URL(address, location.href).href;
  event.dataTransfer?.setData("DownloadURL", `application/octet-stream:${name.replace(/\.[^.]*$/, "")}.bvh:${url}`);
  event.dataTransfer?.setData("text/uri-list", url);
  event.stopPropagation();
}

async function toggle(star, hit) {
  if (!edit) return told("Start the server with --edit to star clips."), (byId("tray").hidden = false);
  const starred = star.getAttribute("aria-pressed") !== "true";
  star.setAttribute("aria-pressed", String(starred));
  try {
    await api.changeMarks({ clips: [hit.clip], star: starred });
    hit.starred = starred;
    changed();
  } catch (error) {
    star.setAttribute("aria-pressed", String(!starred));
    told(/** @type {Error} */ (error).message);
  }
}

/** What people and text say of a hit, as chips on its card. @param {import("./api.js").Hit} hit */
export function labels(hit) {
  const words = [...(hit.matched ?? []).map((place) => el("span", { class: "matched", title: "has the words of the question there" }, place)), ...(hit.mirrored ? [el("span", {}, "mirrored")] : []), ...(hit.tags ?? []).map((tag) => el("span", { class: "tag" }, tag))];
  return words.length ? el("p", { class: "labels" }, ...words) : null;
}
