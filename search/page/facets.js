/**
 * Facets: what the filters would leave, by folder, format, rig, length, tag and collection, with counts.
 */

import * as api from "./api.js";
import { byId, el } from "./dom.js";
import { filters, go, read } from "./state.js";

const SHOWN = 8; // values of a facet until more are asked for
const TITLES = { folder: "Folder", format: "Format", rig: "Rig", length: "Length", tag: "Tag", collection: "Collection", starred: "Starred" };

let asked = "";

/** Show the facets of a state, if they are open. @param {import("./state.js").State} state @param {boolean} [again] although they were shown for these filters */
export async function showFacets(state, again = false) {
  if (byId("filters").hidden) return;
  const key = JSON.stringify(filters(state));
  if (key === asked && !again) return;
  asked = key;
  const found = await api.facets(filters(state)).catch(() => null);
  if (!found || key !== asked) return;
  byId("facets").replaceChildren(...Object.keys(TITLES).map((name) => facet(name, found[name], state)).filter(Boolean));
}

function facet(name, values, state) {
  if (!values.length) return null;
  const items = values.map((value) => choice(name, value, state));
  for (const item of items.slice(SHOWN)) item.hidden = item.firstChild.getAttribute("aria-pressed") === "false";
  const hidden = items.filter((item) => item.hidden).length;
  const more = el("button", { type: "button", class: "plain", onclick: (event) => { items.forEach((item) => (item.hidden = false)); event.target.remove(); } }, `${hidden} more`); // prettier-ignore
  return el("fieldset", {}, el("legend", {}, TITLES[name]), el("ul", {}, ...items), hidden ? more : null);
}

function choice(name, { value, count, from, to }, state) {
  const changes = changed(name, value, from, to);
  const chosen = Object.entries(changes).every(([key, given]) => state[key] === given);
  const off = Object.fromEntries(Object.keys(changes).map((key) => [key, ""]));
  const text = name === "length" ? lengths(from, to) : name === "starred" ? "★" : value || "none";
  return el("li", {}, el("button", { type: "button", class: "facet", "aria-pressed": String(chosen), title: value ?? text, onclick: () => go(chosen ? off : changes, { quietly: true }) },
    el("span", {}, text), el("span", { class: "count" }, count.toLocaleString("en")))); // prettier-ignore
}

/** The filters that a value stands for. */
function changed(name, value, from, to) {
  if (name === "length") return { min: from ? String(from) : "", max: to ? String(to) : "" };
  if (name === "starred") return { starred: "true" };
  return { [name === "folder" ? "path" : name]: value };
}

const lengths = (from, to) => (!from ? `under ${to} s` : to ? `${from} to ${to} s` : `${from} s and more`);

/** Listen for the panel being opened. */
export function listenToFacets() {
  byId("filters-button").addEventListener("click", () => showFacets(read(), true));
}
