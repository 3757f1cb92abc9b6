/**
 * The library as points in a plane: colours say what clips look like, the query lights up its answers.
 */

import * as api from "./api.js";
import { byId, clamp, el } from "./dom.js";
import { filters, go, link } from "./state.js";

const COLOURS = 8; // labels with a colour of their own; the others share one
const MARGIN = 26;
const NEAR = 14; // pixels around a point that count as on it
const MOST_PICKED = 60;
const ANSWERS = 60;

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
    this.picked = new Set();
    /** @type {Map<number, import("./api.js").Hit>} place in the data -> what the query says of it */
    this.answers = new Map();
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
      byId("map-note").textContent = "Laying out the library…";
      try {
        this.data = await api.map();
      } catch (error) {
        byId("map-note").textContent = /** @type {Error} */ (error).message;
        return;
      }
    }
    byId("map-note").textContent = this.data.clips.length ? "" : "The library is empty: motionseek index FOLDER fills it.";
    this.#showLabels();
    await this.#light(state);
  }

  /** The library grew, or the theme changed. */
  refresh({ again = false } = {}) {
    if (again) this.data = null;
    this.draw();
  }

  /** All points, and what lies over them. */
  draw() {
    const { canvas, data } = this;
    if (!canvas.clientWidth || !data) return;
    const ratio = Math.min(devicePixelRatio, 2);
    for (const sheet of [canvas, this.points]) [sheet.width, sheet.height] = [canvas.clientWidth * ratio, canvas.clientHeight * ratio];
    const pen = this.points.getContext("2d");
    const style = getComputedStyle(document.documentElement);
    const colours = Array.from({ length: COLOURS + 1 }, (_, kind) => style.getPropertyValue(kind < COLOURS ? `--kind-${kind}` : "--kind-other"));
    const lit = this.answers.size > 0;
    pen.scale(ratio, ratio);
    data.clips.forEach((_, i) => {
      const [x, y] = this.#place(i);
      const dim = (lit && !this.answers.has(i)) || (this.picked.size > 0 && !this.picked.has(i));
      pen.globalAlpha = dim ? 0.22 : 1;
      pen.fillStyle = colours[Math.min(data.label[i], COLOURS)];
      pen.beginPath();
      pen.arc(x, y, this.#size(), 0, 7);
      pen.fill();
    });
    this.#mark();
  }

  /** Rings and the lasso over the points, which stay as they are: a library may have a hundred thousand. */
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
    for (const [i, { strength }] of this.answers) ring(pen, ...this.#place(i), this.#size() + 3.5, accent, strength === "strong" ? 2.5 : 1.25);
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

  /** Ring the answers of the sentence. @param {import("./state.js").State} state */
  async #light(state) {
    this.answers = new Map();
    const data = /** @type {import("./api.js").MapData} */ (this.data);
    if (state.q) {
      const { hits } = await api.search(state.q, filters(state), ANSWERS, 0).catch(() => ({ hits: [] }));
      const place = new Map(data.clips.map((clip, i) => [clip, i]));
      const sure = hits.filter((hit) => hit.strength === "strong" || hit.strength === "plausible");
      for (const hit of sure.length ? sure : hits.slice(0, 5)) {
        const i = place.get(/** @type {number} */ (hit.clip));
        if (i !== undefined) this.answers.set(i, hit);
      }
      byId("map-said").textContent = sure.length ? `${this.answers.size} clips answer “${state.q}”.` : `Nothing surely answers “${state.q}”: the nearest are ringed.`;
    } else byId("map-said").textContent = "Hover to see a clip move. Draw around points to pick them (Shift: a rectangle), or Shift and click.";
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
        this.#take(this.#where((j) => data.label[j] === kind), kind);
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
      if (lasso.length > 2) this.#take(this.#where((i) => inside(this.#place(i), lasso)));
      else if (this.hovered < 0) this.#take(new Set());
      else if (event.shiftKey) this.#toggle(this.hovered);
      else go({ clip: String(this.data?.clips[this.hovered]) });
    };
    for (const name of ["pointerup", "pointercancel"]) addEventListener(name, end, { signal: stop.signal });
  }

  /** The places in the data that meet a condition. @param {(i: number) => boolean} condition */
  #where(condition) {
    return new Set(/** @type {import("./api.js").MapData} */ (this.data).clips.map((_, i) => i).filter(condition));
  }

  /** Pick a point more, or let go of it. @param {number} i */
  #toggle(i) {
    const picked = new Set(this.picked);
    if (!picked.delete(i)) picked.add(i);
    this.#take(picked);
  }

  /** Pick points, those of a label where one was chosen; none lets go of all. @param {Set<number>} picked */
  #take(picked, label = -1) {
    const data = /** @type {import("./api.js").MapData} */ (this.data);
    [this.picked, this.label] = [picked, label];
    [...byId("labels").querySelectorAll("button")].forEach((button, i) => button.setAttribute("aria-pressed", String(i === label)));
    const ids = [...this.picked].map((i) => data.clips[i]);
    const shown = ids.slice(0, MOST_PICKED);
    byId("picked").hidden = !ids.length;
    byId("picked").textContent = `Show ${ids.length > shown.length ? `${shown.length} of ` : ""}${ids.length} picked`;
    byId("picked").href = link({ view: "", ids: shown.join(","), q: "", like: "" });
    byId("map-said").textContent = ids.length ? `${ids.length} clips picked.` : "Nothing picked.";
    this.draw();
  }

  /** Arrow keys go to the nearest point that way. @param {KeyboardEvent} event */
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
    if (this.hovered < 0) return this.#hover([...this.answers.keys()][0] ?? 0);
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
    if (aloud) byId("map-said").textContent = text;
    const answer = this.answers.get(i);
    const motion = await api.joints(this.data.clips[i], answer?.start ?? 0, answer ? answer.end : 8).catch(() => null);
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

/** Whether a point lies inside a polygon, by how often a ray crosses its edges. */
function inside([x, y], corners) {
  let odd = false;
  corners.forEach(([ax, ay], i) => {
    const [bx, by] = corners[(i + 1) % corners.length];
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) odd = !odd;
  });
  return odd;
}
