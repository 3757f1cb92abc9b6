/**
 * The time line of a composition: a block for each sentence, in rows, to be dragged and stretched by pointer or keys.
 */

import { clamp, el } from "./dom.js";

/** Seconds of a sentence, at least. */
export const SHORTEST = 0.5;
const LEAST = 12; // seconds that are shown
const ROOM = 3; // seconds beyond the last sentence
const STEP = 0.1; // seconds
const NARROW = 72; // pixels; the ends of a narrower block are moved by keys and the form alone
const COLOURS = 6;

/**
 * @typedef {{id: number, text: string, start: number, end: number, parts: string[], clip: number | null, at: number | null}} Sentence
 *   `clip` and `at`: what it is to be shown by, and the middle of the span, in seconds of its file
 * @typedef {"move" | "start" | "end"} Grip
 */

export class Line {
  /**
   * @param {HTMLElement} root
   * @param {{onChange: (sentences: Sentence[], done: boolean) => void, onSelect: (i: number) => void,
   *   onRemove: (i: number) => void, onOpen: () => void, onSeek: (time: number) => void}} calls
   */
  constructor(root, calls) {
    Object.assign(this, { root, calls, span: LEAST, now: 0, held: false });
    /** @type {Sentence[]} */
    this.sentences = [];
    /** @type {Map<number, HTMLElement[]>} id -> block and edges, kept so that focus stays */
    this.nodes = new Map();
    this.ruler = el("div", { class: "ruler", "aria-hidden": "true" });
    this.rows = el("div", { class: "rows" });
    this.head = el("div", { class: "head", role: "slider", tabindex: 0, "aria-label": "Position", "aria-valuemin": 0 });
    root.replaceChildren(this.ruler, this.rows, this.head);
    this.ruler.addEventListener("pointerdown", (event) => this.#scrub(event));
    this.head.addEventListener("pointerdown", (event) => this.#scrub(event));
    this.head.addEventListener("keydown", (event) => {
      const step = event.shiftKey ? 1 : 0.05;
      const to = { ArrowLeft: this.now - step, ArrowRight: this.now + step, Home: 0, End: this.#end() }[event.key];
      if (to === undefined) return;
      event.preventDefault();
      event.stopPropagation();
      calls.onSeek(clamp(to, 0, this.#end()));
    });
  }

  /** @param {Sentence[]} sentences @param {number} selected @param {(i: number) => import("./api.js").ComposedInterval | null} shown what shows each */
  draw(sentences, selected, shown) {
    this.sentences = sentences;
    if (!this.held) this.span = Math.max(this.#end() + ROOM, LEAST);
    const rows = rowsOf(sentences);
    this.root.style.setProperty("--rows", String(Math.max(0, ...rows) + 1));
    const gone = new Set(this.nodes.keys());
    sentences.forEach((one, i) => {
      gone.delete(one.id);
      const [block, start, end] = this.nodes.get(one.id) ?? this.#make(one.id);
      const by = shown(i);
      block.className = `block c${i % COLOURS}${i === selected ? " selected" : ""}`;
      block.replaceChildren(el("strong", {}, one.text), el("small", {}, by ? by.path.split("/").pop() : ""));
      const said = `${one.start.toFixed(1)} to ${one.end.toFixed(1)} seconds`;
      block.title = by ? `${one.text}, ${said}: ${by.path}` : `${one.text}, ${said}`;
      for (const [node, name, value] of /** @type {[HTMLElement, string, number][]} */ ([[block, one.text, one.start], [start, `Start of ${one.text}`, one.start], [end, `End of ${one.text}`, one.end]])) {
        node.setAttribute("aria-label", name);
        node.setAttribute("aria-valuemin", "0");
        node.setAttribute("aria-valuemax", this.span.toFixed(1));
        node.setAttribute("aria-valuenow", value.toFixed(1));
        node.setAttribute("aria-valuetext", node === block ? said : `${value.toFixed(1)} seconds`);
        node.style.setProperty("--row", String(rows[i]));
      }
      block.style.left = start.style.left = this.#percent(one.start);
      block.style.width = this.#percent(one.end - one.start);
      end.style.left = this.#percent(one.end);
      start.hidden = end.hidden = !this.held && ((one.end - one.start) / this.span) * this.rows.clientWidth < NARROW;
      this.rows.append(...(block.isConnected ? [] : [block, start, end]));
    });
    for (const id of gone) {
      for (const node of this.nodes.get(id) ?? []) node.remove();
      this.nodes.delete(id);
    }
    const step = this.span > 120 ? 20 : this.span > 50 ? 10 : this.span > 24 ? 5 : this.span > 14 ? 2 : 1;
    this.ruler.replaceChildren(...Array.from({ length: Math.floor(this.span / step) + 1 }, (_, i) => {
      const mark = el("span", {}, i * step);
      mark.style.left = this.#percent(i * step);
      return mark;
    })); // prettier-ignore
    this.seek(this.now);
  }

  /** @param {number} time */
  seek(time) {
    this.now = time;
    this.head.style.left = this.#percent(time);
    this.head.setAttribute("aria-valuemax", this.#end().toFixed(2));
    this.head.setAttribute("aria-valuenow", time.toFixed(2));
    this.head.setAttribute("aria-valuetext", `${time.toFixed(2)} seconds`);
  }

  #end() {
    return Math.max(0, ...this.sentences.map((one) => one.end));
  }

  /** @param {number} seconds */
  #percent(seconds) {
    return `${(100 * seconds) / this.span}%`;
  }

  /** The nodes of a sentence: a block, and its two edges. @param {number} id */
  #make(id) {
    const grips = /** @type {[Grip, string][]} */ ([["move", "block"], ["start", "edge"], ["end", "edge"]]);
    const nodes = grips.map(([grip, kind]) => {
      const node = el("div", { class: kind, role: "slider", tabindex: 0 });
      node.addEventListener("pointerdown", (event) => this.#drag(event, id, grip));
      node.addEventListener("keydown", (event) => this.#key(event, id, grip));
      node.addEventListener("focus", () => this.calls.onSelect(this.#at(id)));
      return node;
    });
    this.nodes.set(id, nodes);
    return nodes;
  }

  /** @param {number} id */
  #at(id) {
    return this.sentences.findIndex((one) => one.id === id);
  }

  /** The sentences with one moved or stretched by seconds. @param {Sentence} one @param {Grip} grip @param {number} by */
  #moved(one, grip, by) {
    const to = (/** @type {number} */ seconds) => Math.round(seconds / STEP) * STEP;
    const length = one.end - one.start;
    const start = grip === "end" ? one.start : clamp(to(one.start + by), 0, grip === "move" ? Infinity : one.end - SHORTEST);
    const end = grip === "start" ? one.end : grip === "move" ? start + length : Math.max(to(one.end + by), one.start + SHORTEST);
    return this.sentences.map((other) => (other.id === one.id ? { ...other, start: Number(start.toFixed(2)), end: Number(end.toFixed(2)) } : other));
  }

  /** @param {PointerEvent} down @param {number} id @param {Grip} grip */
  #drag(down, id, grip) {
    if (down.button !== 0) return;
    const first = this.sentences[this.#at(id)];
    const { width } = this.rows.getBoundingClientRect();
    const by = (/** @type {PointerEvent} */ event) => ((event.clientX - down.clientX) / width) * this.span;
    let moved = false;
    const stop = new AbortController();
    addEventListener("pointermove", (event) => {
      moved ||= Math.abs(event.clientX - down.clientX) > 3;
      this.held = moved;
      if (moved) this.calls.onChange(this.#moved(first, grip, by(event)), false);
    }, { signal: stop.signal }); // prettier-ignore
    for (const name of ["pointerup", "pointercancel"])
      addEventListener(name, (event) => {
        stop.abort();
        this.held = false;
        if (moved) this.calls.onChange(this.#moved(first, grip, name === "pointerup" ? by(/** @type {PointerEvent} */ (event)) : 0), true);
      }, { signal: stop.signal }); // prettier-ignore
  }

  /** @param {KeyboardEvent} event @param {number} id @param {Grip} grip */
  #key(event, id, grip) {
    const step = event.shiftKey ? 1 : STEP;
    const by = { ArrowLeft: -step, ArrowDown: -step, ArrowRight: step, ArrowUp: step }[event.key];
    const at = this.#at(id);
    if (by !== undefined) this.calls.onChange(this.#moved(this.sentences[at], grip, by), true);
    else if (event.key === "Enter") this.calls.onOpen();
    else if (event.key === "Delete" || event.key === "Backspace") this.calls.onRemove(at);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** @param {PointerEvent} down */
  #scrub(down) {
    if (down.button !== 0) return;
    const seek = (/** @type {MouseEvent} */ event) => {
      const { left, width } = this.ruler.getBoundingClientRect();
      this.calls.onSeek(clamp(((event.clientX - left) / width) * this.span, 0, this.#end()));
    };
    const stop = new AbortController();
    addEventListener("pointermove", seek, { signal: stop.signal });
    for (const name of ["pointerup", "pointercancel"]) addEventListener(name, () => stop.abort(), { signal: stop.signal });
    seek(down);
  }
}

/** The row of each sentence: the first that is free. @param {Sentence[]} sentences */
function rowsOf(sentences) {
  /** @type {number[]} when each row is free again */
  const free = [];
  const order = sentences.map((_, i) => i).sort((a, b) => sentences[a].start - sentences[b].start || sentences[b].end - sentences[a].end);
  const rows = new Array(sentences.length).fill(0);
  for (const i of order) {
    const row = free.findIndex((end) => end <= sentences[i].start + 0.01);
    rows[i] = row < 0 ? free.length : row;
    free[rows[i]] = sentences[i].end;
  }
  return rows;
}
