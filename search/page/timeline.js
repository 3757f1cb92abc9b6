/**
 * The time line of a take: one track a sentence with similarity and moments, in and out points, the play head. When
 * zoomed it is wider than its container, which scrolls.
 */

import { clamp, clock, el, svg } from "./dom.js";
import { Poses } from "./poses.js";

const HEIGHT = 32;
const EDGE = 24; // pixels beside the strip, for the handles
const MIN_RANGE = 0.2; // of similarity that is scaled to the full height
const SHORTEST_CUT = 0.1;
const MIN_VISIBLE = 20; // seconds
const MARKS = 12; // visible on the ruler, at most

/**
 * @typedef {{text: string, colour: number, removable: boolean, times: number[], similarity: number[],
 *   moments: import("./api.js").Hit[], note: string}} Track
 */

export class Timeline {
  /**
   * @param {HTMLElement} root
   * @param {{onSeek: (time: number) => void, onCut: (from: number, to: number, done: boolean) => void,
   *   onRemove: (text: string) => void, onMoment: (hit: import("./api.js").Hit) => void}} calls
   */
  constructor(root, calls) {
    Object.assign(this, { root, calls, duration: 1, from: 0, to: 1, now: 0, zoom: 1 });
    this.tracks = el("div", { class: "tracks" });
    this.ruler = el("div", { class: "ruler", "aria-hidden": "true" });
    this.feet = el("div", { class: "feet", hidden: true });
    const canvas = /** @type {HTMLCanvasElement} */ (el("canvas", { class: "poses", "aria-hidden": "true" }));
    this.poses = new Poses(canvas);
    this.before = el("div", { class: "shade" });
    this.after = el("div", { class: "shade" });
    this.head = this.#slider("head", "Position", (time) => calls.onSeek(time));
    this.in = this.#slider("handle in", "In point", (time, done) => this.#cut(time, this.to, done));
    this.out = this.#slider("handle out", "Out point", (time, done) => this.#cut(this.from, time, done));
    const over = el("div", { class: "over" }, this.before, this.after, this.in, this.out, this.head);
    this.strip = el("div", { class: "strip" }, this.ruler, canvas, this.feet, this.tracks, over);
    root.replaceChildren(this.strip);
    root.addEventListener("pointerdown", (event) => {
      if (/** @type {Element} */ (event.target).closest("button, [role=slider]") || event.button !== 0) return;
      this.#drag(event, (time) => calls.onSeek(time));
    });
    root.addEventListener("scroll", () => this.drawPoses(), { passive: true });
    new ResizeObserver(() => this.drawPoses()).observe(root);
    root.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.zoomBy(Math.exp(-event.deltaY * 0.005), this.#time(event));
    }, { passive: false }); // prettier-ignore
  }

  /** @param {number} duration @param {number} from @param {number} to */
  open(duration, from, to) {
    this.duration = Math.max(duration, 0.05);
    this.mark(from, to);
    this.zoomBy(0);
  }

  /** The largest zoom. */
  get most() {
    return Math.max(this.duration / MIN_VISIBLE, 1);
  }

  /** Zoom in (factor above 1) or out around a time; 0 shows the whole take. @param {number} factor */
  zoomBy(factor, time = this.now) {
    const before = this.#place(time);
    this.zoom = clamp(this.zoom * factor, 1, this.most);
    this.strip.style.setProperty("--zoom", String(this.zoom));
    this.root.scrollLeft += this.#place(time) - before;
    if (factor !== 0 && time === this.now) this.#reveal();
    this.#rule();
    this.drawPoses();
  }

  /** Draw the strip of poses. */
  drawPoses() {
    this.poses.canvas.style.width = `${this.root.clientWidth - 2 * EDGE}px`;
    const { left } = this.poses.canvas.getBoundingClientRect();
    const ruler = this.ruler.getBoundingClientRect();
    this.poses.draw((time) => this.#place(time) - left, (x) => ((x + left - ruler.left) / ruler.width) * this.duration);
  }

  /** Show when the feet stand. @param {import("./contacts.js").Contact[]} contacts none hides it */
  showContacts(contacts) {
    this.feet.hidden = !contacts.length;
    const bar = ({ start, end }) => svg("rect", { x: (1000 * start) / this.duration, y: 0, width: (1000 * (end - start)) / this.duration, height: 1 });
    this.feet.replaceChildren(...(contacts.length ? ["left", "right"] : []).map((side) => {
      const own = contacts.filter((contact) => contact.side === side);
      return svg("svg", { class: side, viewBox: "0 0 1000 1", preserveAspectRatio: "none", role: "img", "aria-label": `${own.length} contacts of the ${side} foot` }, ...own.map(bar));
    })); // prettier-ignore
  }

  #rule() {
    const seen = this.duration / this.zoom;
    const step = [0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600].find((seconds) => seen / seconds <= MARKS) ?? 1800;
    const marks = Array.from({ length: Math.floor(this.duration / step) + 1 }, (_, i) => i * step);
    this.ruler.replaceChildren(...marks.map((at) => this.#at(el("span", {}, step < 1 ? at.toFixed(1) : at < 60 ? `${at}` : clock(at)), at)));
  }

  /** The x coordinate of a time, in pixels of the window. @param {number} time */
  #place(time) {
    const { left, width } = this.ruler.getBoundingClientRect();
    return left + (time / this.duration) * width;
  }

  /** The time under the pointer. @param {MouseEvent} event */
  #time(event) {
    const { left, width } = this.ruler.getBoundingClientRect();
    return clamp((event.clientX - left) / width, 0, 1) * this.duration;
  }

  /** How far the play head is outside the visible part, in pixels. */
  #outside() {
    const { left, right } = this.root.getBoundingClientRect();
    const place = this.#place(this.now);
    return Math.min(place - left, 0) + Math.max(place - right, 0);
  }

  /** Scroll to the play head, so that what follows it is visible. */
  #reveal() {
    if (this.#outside()) this.root.scrollLeft += this.#place(this.now) - this.root.getBoundingClientRect().left - 0.1 * this.root.clientWidth;
  }

  /** Show the in and out points. @param {number} from @param {number} to */
  mark(from, to) {
    [this.from, this.to] = [from, to];
    this.before.style.width = `${(100 * from) / this.duration}%`;
    this.after.style.left = `${(100 * to) / this.duration}%`;
    this.#value(this.in, from);
    this.#value(this.out, to);
  }

  /** @param {number} time */
  seek(time) {
    const followed = this.zoom > 1 && !this.held && !this.#outside(); // not after the user has scrolled away
    this.now = time;
    this.#value(this.head, time);
    if (followed) this.#reveal();
  }

  /** @param {Track[]} tracks drawn on one scale, to be comparable */
  draw(tracks) {
    const all = tracks.flatMap((track) => track.similarity);
    const top = all.reduce((most, value) => Math.max(most, value), MIN_RANGE);
    const bottom = all.reduce((least, value) => Math.min(least, value), top - MIN_RANGE);
    this.tracks.replaceChildren(...tracks.map((track) => this.#track(track, bottom, top)));
  }

  /** @param {Track} track @param {number} bottom @param {number} top */
  #track(track, bottom, top) {
    const points = track.times.map((time, i) => {
      const y = HEIGHT - 1 - ((track.similarity[i] - bottom) / (top - bottom)) * (HEIGHT - 3);
      return `${((1000 * time) / this.duration).toFixed(1)},${y.toFixed(1)}`;
    });
    const ends = [track.times[0], track.times.at(-1) ?? 0].map((time) => (1000 * time) / this.duration);
    const line = points.length ? `M${points.join("L")}` : "";
    const curve = svg("svg", { viewBox: `0 0 1000 ${HEIGHT}`, preserveAspectRatio: "none", "aria-hidden": "true" },
      svg("path", { class: "area", d: line && `${line}L${ends[1]},${HEIGHT}L${ends[0]},${HEIGHT}Z` }),
      svg("path", { class: "line", d: line })); // prettier-ignore
    const moments = track.moments.map((hit) => this.#moment(track, hit));
    const remove = track.removable ? el("button", { type: "button", class: "remove", "aria-label": `Remove the track “${track.text}”`, onclick: () => this.calls.onRemove(track.text) }, "×") : null;
    return el("div", { class: `track c${track.colour}` },
      el("p", { class: "name" }, el("span", { class: "swatch", "aria-hidden": "true" }), track.text, el("small", {}, track.note), remove),
      el("div", { class: "plot" }, curve, ...moments)); // prettier-ignore
  }

  /** @param {Track} track @param {import("./api.js").Hit} hit */
  #moment(track, hit) {
    const label = `${track.text}: ${hit.start.toFixed(1)} to ${hit.end.toFixed(1)} s${hit.strength && `, ${hit.strength}`}`;
    const button = el("button", { type: "button", class: `moment ${hit.strength || "unrated"}`, "aria-label": label, title: label, onclick: () => this.calls.onMoment(hit) });
    button.style.width = `${(100 * (hit.end - hit.start)) / this.duration}%`;
    return this.#at(button, hit.start);
  }

  /** @param {number} from @param {number} to @param {boolean} done */
  #cut(from, to, done) {
    const moved = from !== this.from;
    if (to - from < SHORTEST_CUT) [from, to] = moved ? [Math.max(to - SHORTEST_CUT, 0), to] : [from, Math.min(from + SHORTEST_CUT, this.duration)];
    this.mark(from, to);
    this.calls.onCut(from, to, done);
  }

  /** @param {string} kind @param {string} name @param {(time: number, done: boolean) => void} set */
  #slider(kind, name, set) {
    const slider = el("div", { class: kind, role: "slider", tabindex: 0, "aria-label": name, "aria-valuemin": 0 });
    slider.addEventListener("pointerdown", (event) => event.button === 0 && this.#drag(event, set));
    slider.addEventListener("keydown", (event) => {
      const step = event.shiftKey ? 1 : 0.05;
      const now = Number(slider.getAttribute("aria-valuenow"));
      const next = { ArrowLeft: now - step, ArrowDown: now - step, ArrowRight: now + step, ArrowUp: now + step, PageUp: now + 5, PageDown: now - 5, Home: 0, End: this.duration }[event.key];
      if (next === undefined) return;
      event.preventDefault();
      event.stopPropagation();
      set(clamp(next, 0, this.duration), true);
    });
    return slider;
  }

  /** @param {PointerEvent} down @param {(time: number, done: boolean) => void} set */
  #drag(down, set) {
    down.stopPropagation();
    const time = (/** @type {PointerEvent} */ event) => this.#time(event);
    this.held = true;
    const stop = new AbortController();
    addEventListener("pointermove", (event) => set(time(event), false), { signal: stop.signal });
    for (const end of ["pointerup", "pointercancel"]) addEventListener(end, (event) => { stop.abort(); this.held = false; set(time(/** @type {PointerEvent} */ (event)), true); }, { signal: stop.signal }); // prettier-ignore
    set(time(down), false);
  }

  /** @param {HTMLElement} slider @param {number} time */
  #value(slider, time) {
    this.#at(slider, time);
    slider.setAttribute("aria-valuemax", this.duration.toFixed(2));
    slider.setAttribute("aria-valuenow", time.toFixed(2));
    slider.setAttribute("aria-valuetext", `${time.toFixed(2)} seconds`);
  }

  #at(node, time) {
    node.style.left = `${(100 * time) / this.duration}%`;
    return node;
  }
}
