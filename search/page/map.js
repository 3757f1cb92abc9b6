/**
 * The library as points in a plane: colours show the nearest description, the hits of the query are ringed.
 */

import * as api from "./api.js";
import { byId, clamp, el } from "./dom.js";
import { filters, go, link } from "./state.js";

const COLOURS = 8; // labels with their own colour; the others share one
const MARGIN = 26;
const NEAR = 14; // pixels: hit radius of a point
const MAX_SELECTED = 60;
const HITS = 60;

export class Plane {
  /** @param {import("./stage.js").Stage | null} stage */
  constructor(stage) {
    this.canvas = byId("points");
    this.points = document.createElement("canvas");
    this.view = stage?.add(/** @type {HTMLElement} */ (byId("peek").firstElementChild)) ?? null;
    /** @type {import("./api.js").MapData | null} */
    this.data = null;
    [this.hovered, this.label] = [-1, -1];
    /** @type {[number, number][]} the lasso, in pixels */
    this.lasso = [];
    /** @type {Set<number>} */
    this.selected = new Set();
    /** @type {Map<number, import("./api.js").Hit>} index in the data -> hit of the query */
    this.hits = new Map();
    this.canvas.addEventListener("pointermove", (/** @type {PointerEvent} */ event) => this.#over(event));
    this.canvas.addEventListener("pointerleave", () => this.#hover(-1));
    this.canvas.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => this.#down(event));
    this.canvas.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => this.#key(event));
    this.canvas.addEventListener("blur", () => this.#hover(-1));
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  /** @param {import("./state.js").State} state */
  async show(state) {
    if (!this.data) {
      byId("map-note").textContent = "Computing the map…";
      try {
        this.data = await api.map();
      } catch (error) {
        byId("map-note").textContent = /** @type {Error} */ (error).message;
        return;
      }
    }
    byId("map-note").textContent = this.data.clips.length ? "" : "The library is empty. Add clips with: motionseek index FOLDER";
    this.#showLabels();
    await this.#showHits(state);
  }

  /** Redraw after a change of the theme, or with `again` of the library. */
  refresh({ again = false } = {}) {
    if (again) this.data = null;
    this.draw();
  }

  /** Draw the points and the overlay. */
  draw() {
    const { canvas, data } = this;
    if (!canvas.clientWidth || !data) return;
    const ratio = Math.min(devicePixelRatio, 2);
    for (const sheet of [canvas, this.points]) [sheet.width, sheet.height] = [canvas.clientWidth * ratio, canvas.clientHeight * ratio];
    const pen = this.points.getContext("2d");
    const style = getComputedStyle(document.documentElement);
    const colours = Array.from({ length: COLOURS + 1 }, (_, kind) => style.getPropertyValue(kind < COLOURS ? `--kind-${kind}` : "--kind-other"));
    const lit = this.hits.size > 0;
    pen.scale(ratio, ratio);
    data.clips.forEach((_, i) => {
      const [x, y] = this.#place(i);
      const dim = (lit && !this.hits.has(i)) || (this.selected.size > 0 && !this.selected.has(i));
      pen.globalAlpha = dim ? 0.22 : 1;
      pen.fillStyle = colours[Math.min(data.label[i], COLOURS)];
      pen.beginPath();
      pen.arc(x, y, this.#size(), 0, 7);
      pen.fill();
    });
    this.#mark();
  }

  /** Draw the overlay, rings and lasso; the points are cached, as there may be a hundred thousand. */
  #mark() {
    const { canvas } = this;
    if (!canvas.clientWidth || !this.data || !this.points.width) return;
    const pen = canvas.getContext("2d");
    const accent = getComputedStyle(document.documentElement).getPropertyValue("--accent");
    const ratio = canvas.width / canvas.clientWidth;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(this.points, 0, 0);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    for (const [i, { strength }] of this.hits) ring(pen, ...this.#place(i), this.#size() + 3.5, accent, strength === "strong" ? 2.5 : 1.25);
    if (this.hovered >= 0) ring(pen, ...this.#place(this.hovered), this.#size() + 6, accent, 2.5);
    if (this.lasso.length < 2) return;
    pen.strokeStyle = accent;
    pen.lineWidth = 1.5;
    pen.setLineDash([5, 4]);
    pen.beginPath();
    this.lasso.forEach(([x, y]) => pen.lineTo(x, y));
    pen.closePath();
    pen.stroke();
    pen.setLineDash([]);
  }

  /** The radius of a point, in pixels. */
  #size() {
    return clamp(90 / Math.sqrt(/** @type {import("./api.js").MapData} */ (this.data).clips.length), 1.2, 6);
  }

  /** @param {number} i @returns {[number, number]} pixels */
  #place(i) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const data = /** @type {import("./api.js").MapData} */ (this.data);
    return [MARGIN + data.x[i] * (width - 2 * MARGIN), MARGIN + (1 - data.y[i]) * (height - 2 * MARGIN)];
  }

  /** Ring the hits of the sentence. @param {import("./state.js").State} state */
  async #showHits(state) {
    this.hits = new Map();
    const data = /** @type {import("./api.js").MapData} */ (this.data);
    if (state.q) {
      const { hits } = await api.search(state.q, filters(state), HITS, 0).catch(() => ({ hits: [] }));
      const place = new Map(data.clips.map((clip, i) => [clip, i]));
      const sure = hits.filter((hit) => hit.strength === "strong" || hit.strength === "plausible");
      for (const hit of sure.length ? sure : hits.slice(0, 5)) {
        const i = place.get(/** @type {number} */ (hit.clip));
        if (i !== undefined) this.hits.set(i, hit);
      }
      byId("map-status").textContent = sure.length ? `${this.hits.size} clips match “${state.q}”.` : `No good match for “${state.q}”; the nearest clips are ringed.`;
    } else byId("map-status").textContent = "Hover to play a clip. Drag to select with a lasso (with Shift: a rectangle), or Shift-click a point.";
    this.draw();
  }

  #showLabels() {
    const data = /** @type {import("./api.js").MapData} */ (this.data);
    const counts = new Array(data.labels.length).fill(0);
    for (const label of data.label) counts[label]++;
    byId("labels").replaceChildren(...data.labels.slice(0, 24).map((text, i) => {
      const button = el("button", { type: "button", "aria-pressed": String(i === this.label) },
        el("span", { class: `swatch k${i < COLOURS ? i : "other"}`, "aria-hidden": "true" }), el("span", {}, text), el("small", {}, counts[i]));
      button.addEventListener("click", () => {
        const kind = this.label === i ? -1 : i;
        this.#select(this.#where((j) => data.label[j] === kind), kind);
      });
      return el("li", {}, button);
    })); // prettier-ignore
  }

  /** @param {PointerEvent} event @returns {[number, number]} */
  #at(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  /** @param {PointerEvent} event */
  #over(event) {
    if (!this.data || this.lasso.length) return;
    const [x, y] = this.#at(event);
    let [best, least] = [-1, NEAR];
    this.data.clips.forEach((_, i) => {
      const [px, py] = this.#place(i);
      const away = Math.hypot(px - x, py - y);
      if (away < least) [best, least] = [i, away];
    });
    this.#hover(best);
  }

  /** @param {PointerEvent} down */
  #down(down) {
    if (!this.data || down.button !== 0) return;
    const [x, y] = this.#at(down);
    const stop = new AbortController();
    addEventListener("pointermove", (event) => {
      const at = this.#at(event);
      if (!this.lasso.length && Math.hypot(at[0] - x, at[1] - y) < 6) return;
      if (event.shiftKey) this.lasso = [[x, y], [at[0], y], at, [x, at[1]]];
      else this.lasso.push(...(this.lasso.length ? [] : [/** @type {[number, number]} */ ([x, y])]), at);
      this.#hover(-1);
      this.#mark();
    }, { signal: stop.signal }); // prettier-ignore
    const end = (/** @type {PointerEvent} */ event) => {
      stop.abort();
      const { lasso } = this;
      this.lasso = [];
      if (lasso.length > 2) this.#select(this.#where((i) => inside(this.#place(i), lasso)));
      else if (this.hovered < 0) this.#select(new Set());
      else if (event.shiftKey) this.#toggle(this.hovered);
      else go({ clip: String(this.data?.clips[this.hovered]) });
    };
    for (const name of ["pointerup", "pointercancel"]) addEventListener(name, end, { signal: stop.signal });
  }

  /** Indices of the points that meet a condition. @param {(i: number) => boolean} condition */
  #where(condition) {
    return new Set(/** @type {import("./api.js").MapData} */ (this.data).clips.map((_, i) => i).filter(condition));
  }

  /** Select or deselect a point. @param {number} i */
  #toggle(i) {
    const selected = new Set(this.selected);
    if (!selected.delete(i)) selected.add(i);
    this.#select(selected);
  }

  /** Replace the selection; `label` is the label it came from. @param {Set<number>} selected */
  #select(selected, label = -1) {
    const data = /** @type {import("./api.js").MapData} */ (this.data);
    [this.selected, this.label] = [selected, label];
    [...byId("labels").querySelectorAll("button")].forEach((button, i) => button.setAttribute("aria-pressed", String(i === label)));
    const ids = [...this.selected].map((i) => data.clips[i]);
    const shown = ids.slice(0, MAX_SELECTED);
    byId("selected").hidden = !ids.length;
    byId("selected").textContent = `Show ${ids.length > shown.length ? `${shown.length} of ` : ""}${ids.length} selected`;
    byId("selected").href = link({ view: "", ids: shown.join(","), q: "", like: "" });
    byId("map-status").textContent = ids.length ? `${ids.length} clips selected.` : "Nothing selected.";
    this.draw();
  }

  /** Arrow keys move to the nearest point in that direction. @param {KeyboardEvent} event */
  #key(event) {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!this.data?.clips.length || event.ctrlKey || event.metaKey) return;
    if (event.key === "Enter" && this.hovered >= 0) go({ clip: String(this.data.clips[this.hovered]) });
    if (event.key === " " && this.hovered >= 0) {
      event.preventDefault();
      event.stopPropagation();
      this.#toggle(this.hovered);
    }
    if (!way) return;
    event.preventDefault();
    if (this.hovered < 0) return this.#hover([...this.hits.keys()][0] ?? 0);
    const [x, y] = this.#place(this.hovered);
    let [best, least] = [this.hovered, Infinity];
    this.data.clips.forEach((_, i) => {
      const [px, py] = this.#place(i);
      const along = (px - x) * way[0] + (py - y) * way[1];
      const aside = Math.abs((px - x) * way[1]) + Math.abs((py - y) * way[0]);
      if (along > 0.5 && along + 2 * aside < least) [best, least] = [i, along + 2 * aside];
    });
    this.#hover(best, true);
  }

  /** @param {number} i @param {boolean} [aloud] */
  async #hover(i, aloud = false) {
    if (i === this.hovered) return;
    this.hovered = i;
    this.canvas.classList.toggle("pointing", i >= 0);
    this.#mark();
    const peek = byId("peek");
    peek.hidden = i < 0;
    if (this.view) this.view.motion = null;
    if (i < 0 || !this.data) return;
    const [x, y] = this.#place(i);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    peek.style.left = `${clamp(x + 18 + 180 > width ? x - 198 : x + 18, 0, Math.max(width - 180, 0))}px`;
    peek.style.top = `${clamp(y - 100, 0, Math.max(height - 240, 0))}px`;
    const text = this.data.labels[this.data.label[i]] ?? "";
    /** @type {HTMLElement} */ (peek.lastElementChild).textContent = text;
    if (aloud) byId("map-status").textContent = text;
    const hit = this.hits.get(i);
    const motion = await api.joints(this.data.clips[i], hit?.start ?? 0, hit ? hit.end : 8).catch(() => null);
    if (!motion || this.hovered !== i || !this.view) return;
    this.view.show(motion);
    this.view.playing = true;
  }
}

function ring(pen, x, y, radius, colour, width) {
  pen.globalAlpha = 1;
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.beginPath();
  pen.arc(x, y, radius, 0, 7);
  pen.stroke();
}

/** Whether a point lies inside a polygon, by ray casting. */
function inside([x, y], corners) {
  let odd = false;
  corners.forEach(([ax, ay], i) => {
    const [bx, by] = corners[(i + 1) % corners.length];
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) odd = !odd;
  });
  return odd;
}
