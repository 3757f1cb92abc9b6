/**
 * The library as points in a plane: colours show the nearest description, the hits of the question are ringed.
 */

import * as api from "./api.js";
import { byId, clamp, el } from "./dom.js";
import { Points } from "./points.js";
import { filters, go, idsOf, likeness, link } from "./state.js";

const COLOURS = 8; // labels with their own colour; the others share one
const LISTED = 24; // labels
const NEAR = 14; // pixels: hit radius of a point
const HITS = 60;
const PEEK = 70; // milliseconds that the pointer rests before a clip is fetched
const POLL = 400; // milliseconds between two questions how far the layout is
const [PEEK_WIDTH, PEEK_HEIGHT] = [180, 240];

export class Plane {
  /** @param {import("./stage.js").Stage | null} stage */
  constructor(stage) {
    this.canvas = byId("points");
    this.points = new Points(byId("points-sheet"), this.canvas);
    this.view = stage?.add(/** @type {HTMLElement} */ (byId("peek").firstElementChild)) ?? null;
    /** @type {import("./api.js").MapData | null} */
    this.data = null;
    [this.hovered, this.label, this.shown] = [-1, -1, 0];
    /** @type {[number, number][]} the lasso, in pixels */
    this.lasso = [];
    /** @type {Set<number>} */
    this.selected = new Set();
    /** @type {Map<number, import("./api.js").Hit>} index in the data -> hit of the question */
    this.hits = new Map();
    this.canvas.addEventListener("pointermove", (/** @type {PointerEvent} */ event) => this.#over(event));
    this.canvas.addEventListener("pointerleave", () => this.#hover(-1));
    this.canvas.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => this.#down(event));
    this.canvas.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => this.#key(event));
    this.canvas.addEventListener("blur", () => this.#hover(-1));
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  /** @param {import("./state.js").State} state @param {boolean} [focus] whether the user comes back to it */
  async show(state, focus = false) {
    const turn = ++this.shown; // an answer to an older state is dropped
    if (focus) this.canvas.focus({ preventScroll: true });
    try {
      const given = filters(state);
      const passing = Object.values(given).some(Boolean) ? api.clips(given) : null;
      const hits = found(state);
      for (const asked of [passing, hits]) asked?.catch(() => {}); // reported below, where they are waited for
      this.data ??= await this.#load();
      const data = this.data;
      const clips = passing && new Set(await passing);
      if (turn !== this.shown) return;
      this.points.passing = Uint8Array.from(data.clips, (clip) => Number(!clips || clips.has(clip)));
      byId("map-note").textContent = data.clips.length ? "" : "The library is empty. Add clips with: motionseek index FOLDER";
      byId("map-sample").textContent = data.clips.length < data.total ? `A sample of ${data.clips.length.toLocaleString("en")} of ${data.total.toLocaleString("en")} clips` : "";
      this.#select(this.points.where((i) => this.selected.has(i)), this.label);
      await this.#showHits(state, await hits, turn);
    } catch (error) {
      if (turn === this.shown) byId("map-note").textContent = /** @type {Error} */ (error).message;
    }
  }

  /** The map; while it is laid out its progress is shown. */
  async #load() {
    byId("map-note").textContent = "Loading the map…";
    for (;;) {
      const answer = await api.map();
      if ("clips" in answer) {
        this.points.set(answer.x, answer.y, answer.label);
        [this.selected, this.label, this.hovered] = [new Set(), -1, -1];
        return answer;
      }
      byId("map-note").textContent = `Laying out ${answer.count.toLocaleString("en")} clips… ${Math.round(100 * answer.progress)} %`;
      await new Promise((done) => setTimeout(done, POLL));
    }
  }

  /** Redraw after a change of the theme, or with `again` of the library. */
  refresh({ again = false } = {}) {
    if (again) this.data = null;
    this.draw();
  }

  /** Draw the points and the overlay. */
  draw() {
    if (!this.data) return;
    const { hits, selected } = this;
    this.points.draw((i) => (!hits.size || hits.has(i)) && (!selected.size || selected.has(i)));
    this.#mark();
  }

  #mark() {
    const rings = [...this.hits].map(([i, { strength }]) => /** @type {[number, number]} */ ([i, strength === "strong" ? 2.5 : 1.25]));
    this.points.mark(rings, this.hovered, this.lasso);
  }

  /** Ring the hits of the question. @param {import("./state.js").State} state @param {import("./api.js").Hit[]} hits @param {number} turn */
  async #showHits(state, hits, turn) {
    if (turn !== this.shown || !this.data) return;
    const place = new Map(this.data.clips.map((clip, i) => [clip, i]));
    const sure = state.q ? hits.filter((hit) => hit.strength === "strong" || hit.strength === "plausible") : hits;
    const ringed = (sure.length ? sure : hits.slice(0, 5)).map((hit) => [place.get(/** @type {number} */ (hit.clip)), hit]);
    this.hits = new Map(/** @type {any} */ (ringed.filter(([i]) => i !== undefined)));
    const passed = this.points.passing.reduce((sum, one) => sum + one, 0);
    const said = [
      state.like && !state.q ? `The ${this.hits.size} most similar clips are ringed.` : "",
      state.q ? (sure.length ? `${hits.length < HITS ? "" : "The best "}${this.hits.size} clips for “${state.q}” are ringed.` : `No good match for “${state.q}”; the nearest clips are ringed.`) : "",
      passed < this.points.length ? `${passed.toLocaleString("en")} of ${this.points.length.toLocaleString("en")} clips pass the filters.` : "",
    ].filter(Boolean);
    byId("map-status").textContent = said.join(" ") || "Hover to play a clip. Drag to select with a lasso (with Shift: a rectangle), or Shift-click a point.";
    this.#showLabels();
    this.draw();
  }

  #showLabels() {
    const { labels, label } = /** @type {import("./api.js").MapData} */ (this.data);
    const counts = new Array(labels.length).fill(0);
    label.forEach((kind, i) => (counts[kind] += this.points.passing[i]));
    const shown = labels.map((text, i) => ({ text, i })).filter(({ i }) => counts[i]).slice(0, LISTED); // prettier-ignore
    byId("labels").replaceChildren(...shown.map(({ text, i }) => {
      const button = el("button", { type: "button", "aria-pressed": String(i === this.label), "data-label": i },
        el("span", { class: `swatch k${i < COLOURS ? i : "other"}`, "aria-hidden": "true" }), el("span", {}, text), el("small", {}, counts[i]));
      button.addEventListener("click", () => {
        const kind = this.label === i ? -1 : i;
        this.#select(this.points.where((j) => label[j] === kind), kind, true);
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
    if (this.data && !this.lasso.length) this.#hover(this.points.nearest(this.#at(event), NEAR));
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
      if (event.type === "pointercancel") this.#mark();
      else if (lasso.length > 2) this.#select(this.points.inside(lasso), -1, true);
      else if (this.hovered < 0) this.#select(new Set(), -1, true);
      else if (event.shiftKey) this.#toggle(this.hovered);
      else this.#open();
    };
    for (const name of ["pointerup", "pointercancel"]) addEventListener(name, end, { signal: stop.signal });
  }

  #open() {
    go({ clip: String(this.data?.clips[this.hovered]) });
  }

  /** Select or deselect a point. @param {number} i */
  #toggle(i) {
    const selected = new Set(this.selected);
    if (!selected.delete(i)) selected.add(i);
    this.#select(selected, -1, true);
  }

  /** Replace the selection. @param {Set<number>} selected @param {number} label it came from, or -1 @param {boolean} [say] */
  #select(selected, label, say = false) {
    const data = /** @type {import("./api.js").MapData} */ (this.data);
    [this.selected, this.label] = [selected, label];
    for (const button of byId("labels").querySelectorAll("button")) button.setAttribute("aria-pressed", String(Number(button.dataset.label) === label));
    const count = selected.size.toLocaleString("en");
    byId("selected").hidden = !selected.size;
    byId("selected").textContent = `Show ${count} selected`;
    byId("selected").href = link({ view: "", ids: idsOf([...selected].map((i) => data.clips[i])), q: "", like: "", from: "", to: "" });
    if (say) byId("map-status").textContent = selected.size ? `${count} clips selected.` : "Nothing selected.";
    this.draw();
  }

  /** Arrow keys move to the nearest point in that direction. @param {KeyboardEvent} event */
  #key(event) {
    const way = /** @type {[number, number] | undefined} */ ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key]);
    if (!this.data?.clips.length || event.ctrlKey || event.metaKey) return;
    if (event.key === "Enter" && this.hovered >= 0) this.#open();
    if (event.key === " " && this.hovered >= 0) {
      event.preventDefault();
      event.stopPropagation();
      this.#toggle(this.hovered);
    }
    if (!way) return;
    event.preventDefault();
    const first = [...this.hits.keys()][0] ?? this.points.passing.indexOf(1);
    this.#hover(this.hovered < 0 ? first : this.points.next(this.hovered, way), true);
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
    const [x, y] = this.points.place(i);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    peek.style.left = `${clamp(x + 18 + PEEK_WIDTH > width ? x - 18 - PEEK_WIDTH : x + 18, 0, Math.max(width - PEEK_WIDTH, 0))}px`;
    peek.style.top = `${clamp(y - 100, 0, Math.max(height - PEEK_HEIGHT, 0))}px`;
    const text = this.data.labels[this.data.label[i]] ?? "";
    /** @type {HTMLElement} */ (peek.lastElementChild).textContent = text;
    if (aloud) byId("map-status").textContent = text;
    await new Promise((done) => setTimeout(done, PEEK));
    if (this.hovered !== i) return;
    const hit = this.hits.get(i);
    const motion = await api.joints(this.data.clips[i], hit?.start ?? 0, hit ? hit.end : 8).catch(() => null);
    if (!motion || this.hovered !== i || !this.view) return;
    this.view.show(motion);
    this.view.playing = true;
  }
}

/** The hits of a question or likeness, none where nothing is asked. @param {import("./state.js").State} state @returns {Promise<import("./api.js").Hit[]>} */
async function found(state) {
  if (state.q) return (await api.search(state.q, likeness(state), filters(state), HITS, 0)).hits;
  return state.like ? (await api.similar(state.like, state.from, state.to, filters(state), HITS, 0)).hits : [];
}
