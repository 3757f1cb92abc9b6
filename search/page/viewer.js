/**
 * One clip: playback, time line, descriptions, cut and export.
 */

import * as api from "./api.js";
import { Compare } from "./compare.js";
import { contacts } from "./contacts.js";
import { byId, clamp, clock, el, strengthMark } from "./dom.js";
import { CLOSED, go, link, note, read } from "./state.js";
import { frameOf, rateOf, timecode } from "./timecode.js";
import { Timeline } from "./timeline.js";
import { Traces } from "./traces.js";
import { Tracks } from "./tracks.js";
import { tools } from "./tray.js";

const LONG = 900; // seconds; longer takes are fetched at half the frame rate
const ROUNDED = 0.002; // seconds that a time may be off, being sent with three digits
const LEAST_CUT = 0.1; // seconds

export class Viewer {
  /**
   * @param {import("./stage.js").Stage | null} stage @param {() => boolean} isPlaying whether clips play when opened
   * @param {() => import("./api.js").Hit[]} results that a clip may be compared with
   */
  constructor(stage, isPlaying, results) {
    Object.assign(this, { isPlaying, clip: "" });
    this.view = stage?.add(byId("big")) ?? null;
    if (this.view) this.view.onTime = () => this.#showTime();
    this.timeline = new Timeline(byId("timeline"), {
      onSeek: (time) => this.seek(time),
      onCut: (from, to, done) => this.cut(from, to, done),
      onRemove: (text) => go({ ask: read().ask.filter((asked) => asked !== text) }, { quietly: true }),
      onMoment: (hit) => this.#goTo(hit),
    });
    this.tracks = new Tracks(this.timeline);
    this.compare = new Compare(stage, this.view, results);
    this.traces = this.view && new Traces(this.view.figure.scene);
    byId("before").addEventListener("click", () => this.stepFrames(-1));
    byId("after").addEventListener("click", () => this.stepFrames(1));
    for (const id of ["path", "feet"]) byId(id).addEventListener("change", () => this.#showTraces());
    byId("play").addEventListener("click", () => this.toggle());
    byId("speed").addEventListener("change", () => this.view && (this.view.speed = Number(byId("speed").value)));
    byId("loop").addEventListener("change", () => this.view && (this.view.loop = byId("loop").checked));
    byId("trail").addEventListener("change", () => this.#showTrail());
    byId("whole").addEventListener("click", () => this.cut(this.begin, this.end, true));
    byId("zoom-in").addEventListener("click", () => this.timeline.zoomBy(2));
    byId("zoom-out").addEventListener("click", () => this.timeline.zoomBy(1 / 2));
    byId("export-format").addEventListener("change", () => this.#showCut());
    byId("ask-track").addEventListener("submit", (/** @type {Event} */ event) => {
      event.preventDefault();
      const text = byId("track").value.trim();
      byId("track").value = "";
      if (text) go({ ask: [...new Set([...read().ask, text])].slice(-8) }, { quietly: true });
    });
  }

  /** @param {import("./state.js").State} state of an open clip */
  async show(state) {
    if (state.clip !== this.clip) await this.#open(state);
    if (!this.info || state.clip !== this.clip) return;
    this.tracks.show(state, this.info.duration);
    this.compare.show(state, this.timeline.from);
  }

  close() {
    this.clip = "";
    this.#clear();
  }

  /** Nothing is open: nothing may be played, cut or exported under the name of another clip. */
  #clear() {
    this.info = null;
    this.tracks.clear();
    this.compare.clear();
    this.traces?.clear();
    this.timeline.showContacts([]);
    this.timeline.poses.motion = null;
    if (this.view) Object.assign(this.view, { motion: null, playing: false });
    byId("viewer").classList.add("empty");
    byId("viewer-error").hidden = true;
    for (const id of ["export", "similar"]) byId(id).removeAttribute("href");
    for (const id of ["viewer-title", "viewer-tools", "viewer-file", "viewer-captions", "described", "viewer-facts", "timecode", "time", "cut"]) byId(id).replaceChildren();
  }

  /** Play or pause. */
  toggle() {
    if (!this.view?.motion) return;
    if (!this.view.playing && this.view.time >= this.view.to) this.view.seek(this.view.from);
    this.view.playing = !this.view.playing;
    this.#showTime();
  }

  /** Where the motion begins, in seconds of its file; a pose before it is left out. */
  get begin() {
    return this.info?.start ?? 0;
  }

  get end() {
    return this.begin + (this.info?.duration ?? 0);
  }

  /** @param {number} from @param {number} to */
  #isWhole(from, to) {
    return from <= this.begin + ROUNDED && to >= this.end - ROUNDED;
  }

  /** @param {number} time */
  seek(time) {
    if (!this.view?.motion) return;
    const { motion } = this.view;
    // Seeking outside of the cut pauses; playback stays within the cut.
    this.view.time = clamp(time, motion.start, motion.end);
    if (time < this.view.from || time > this.view.to) this.view.playing = false;
    this.view.stage.dirty = true;
    this.#showTime();
  }

  /** Go some frames of the file on, to where one begins. @param {number} count */
  stepFrames(count) {
    if (!this.view?.motion) return;
    const fps = rateOf(this.info);
    this.view.playing = false;
    this.seek((frameOf(this.view.time, fps) + count) / fps);
  }

  /** Set the in or out point at the play head. @param {"in" | "out"} end */
  markHere(end) {
    if (!this.info || !this.view) return;
    const { time } = this.view;
    if (end === "in") this.cut(time, Math.max(this.timeline.to, Math.min(time + LEAST_CUT, this.end)), true);
    else this.cut(Math.min(this.timeline.from, Math.max(time - LEAST_CUT, this.begin)), time, true);
  }

  /** Set the in and out points. @param {number} from @param {number} to @param {boolean} done whether to update the URL fragment */
  cut(from, to, done) {
    if (!this.info) return;
    this.timeline.mark(from, to);
    if (this.view) [this.view.from, this.view.to] = [from, Math.min(to, this.view.motion?.end ?? to)];
    const whole = this.#isWhole(from, to);
    if (done) note({ a: whole ? "" : from.toFixed(2), b: whole ? "" : to.toFixed(2) });
    if (done && this.view && (this.view.time < from || this.view.time > to)) this.view.seek(from);
    this.compare.from = from;
    this.#showCut();
  }

  /** @param {import("./state.js").State} state */
  async #open(state) {
    this.#clear();
    this.clip = state.clip;
    document.title = "motionseek";
    byId("viewer-status").textContent = "Loading…";
    byId("big").classList.add("loading");
    try {
      const info = await api.motion(state.clip);
      const motion = await api.joints(state.clip, undefined, undefined, info.duration > LONG ? 10 : 20);
      if (state.clip !== this.clip) return;
      this.info = info;
      byId("viewer").classList.remove("empty");
      this.#showInfo(info);
      const [from, to] = this.#cutOf(state);
      if (this.view) {
        this.view.show(motion);
        this.timeline.poses.motion = motion;
        this.contacts = contacts(motion);
        this.#showTraces();
        Object.assign(this.view, { playing: this.isPlaying(), loop: byId("loop").checked, speed: Number(byId("speed").value) });
      }
      this.timeline.open(this.end, this.begin, this.end);
      byId("zoom").hidden = this.timeline.most <= 1;
      this.cut(from, to, false);
      this.view?.seek(from);
      byId("viewer-status").textContent = "";
      byId("viewer-title").focus({ preventScroll: true });
    } catch (error) {
      if (state.clip === this.clip) this.#fail(/** @type {Error} */ (error), state);
      return;
    }
    byId("big").classList.remove("loading");
    this.#describe(state.clip);
  }

  /** The in and out points of a state; all of the take where they are none in it. @param {import("./state.js").State} state */
  #cutOf({ a, b }) {
    const [from, to] = [Math.max(Number(a) || 0, this.begin), Math.min(Number(b) || this.end, this.end)];
    return from < to ? [from, to] : [this.begin, this.end];
  }

  /** The clip could not be opened. @param {Error} error @param {import("./state.js").State} state */
  #fail(error, state) {
    this.clip = "";
    this.#clear();
    byId("viewer-title").textContent = "This clip could not be opened";
    byId("viewer-status").textContent = "";
    byId("big").classList.remove("loading");
    byId("viewer-error").hidden = false;
    const again = el("button", { type: "button", onclick: () => this.show(state) }, "Try again");
    byId("viewer-error").replaceChildren(el("p", {}, error.message), again);
    byId("viewer-title").focus({ preventScroll: true });
  }

  /** @param {import("./api.js").MotionInfo} info */
  #showInfo(info) {
    document.title = `${info.name} – motionseek`;
    this.hit = { ...info };
    byId("viewer-title").textContent = info.name;
    byId("viewer-file").textContent = info.root ? `#${info.clip} · ${info.root} · ${info.path}` : info.path;
    const facts = { Duration: clock(info.duration), Frames: info.source_fps ? `${info.source_frames} at ${+info.source_fps.toFixed(2)} fps` : `${info.frames}, read at ${+info.fps.toFixed(2)} fps`, Format: info.format, Rig: info.rig };
    byId("viewer-facts").replaceChildren(...Object.entries(facts).flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]));
    const captions = (info.captions ?? []).slice(0, 6).map(({ text, start, end }) =>
      el("blockquote", {}, text, start === null ? null : el("small", {}, ` ${start.toFixed(1)}–${(end ?? this.end).toFixed(1)} s`)));
    byId("viewer-captions").replaceChildren(...captions); // prettier-ignore
  }

  /** @param {string} clip */
  async #describe(clip) {
    try {
      const { sentences } = await api.describe(clip);
      if (clip !== this.clip) return;
      const known = !sentences.every(({ strength }) => strength === "weak");
      byId("described").replaceChildren(...(known ? [] : [el("li", { class: "quiet" }, "Nothing the model knows fits well. The nearest:")]), ...sentences.map(({ text, score, strength }) =>
        el("li", {}, el("a", { href: link({ ...CLOSED, q: text, like: "", ids: "", view: "" }) }, text), strengthMark(strength), el("span", { class: "score" }, score.toFixed(2))))); // prettier-ignore
    } catch (error) {
      byId("described").replaceChildren(el("li", {}, /** @type {Error} */ (error).message));
    }
  }

  /** @param {import("./api.js").Hit} hit */
  #goTo(hit) {
    this.cut(hit.start, hit.end, true);
    this.seek(hit.start);
    if (this.view) this.view.playing = this.isPlaying();
    this.#showTime();
  }

  #showTrail() {
    if (!this.view) return;
    this.view.figure.trail.visible = byId("trail").checked;
    this.view.stage.dirty = true;
  }

  /** Draw the path of the root and the contacts of the feet, where they are switched on. */
  #showTraces() {
    if (!this.view?.motion || !this.traces) return;
    const [path, prints] = [byId("path").checked, byId("feet").checked];
    this.traces.show(this.view.motion, this.contacts, this.view.stage.palette, { path, prints });
    this.timeline.showContacts(prints ? this.contacts : []);
    this.view.stage.dirty = true;
  }

  /** Draw anew after a change of the theme. */
  repaint() {
    this.#showTraces();
    this.timeline.drawPoses();
  }

  #showTime() {
    if (!this.view || !this.info) return;
    const { time, playing } = this.view;
    const fps = rateOf(this.info);
    this.timeline.seek(time);
    this.compare.seek(time);
    byId("timecode").textContent = timecode(time, fps);
    byId("time").textContent = `${time.toFixed(2)} s · frame ${frameOf(time, fps)} / ${(this.info.source_frames ?? frameOf(this.end, fps) + 1) - 1}`;
    byId("play").classList.toggle("playing", playing);
    byId("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  }

  #showCut() {
    if (!this.info) return;
    const { from, to } = this.timeline;
    const whole = this.#isWhole(from, to);
    const [start, end] = whole ? [undefined, undefined] : [from.toFixed(3), to.toFixed(3)];
    const frames = [from, to].map((time) => frameOf(time, rateOf(this.info)));
    byId("cut").textContent = whole ? "the whole take" : `${from.toFixed(2)}–${to.toFixed(2)} s · frames ${frames[0]}–${frames[1]}`;
    byId("viewer-tools").replaceChildren(tools(Object.assign(this.hit, { start: from, end: to })));
    byId("whole").disabled = whole;
    byId("export").textContent = whole ? "Export the take" : "Export the cut";
    byId("export").href = api.exportAddress(this.clip, start, end, byId("export-format").value);
    byId("similar").href = link({ ...CLOSED, q: "", view: "", ids: "", like: this.clip, from: whole ? "" : from.toFixed(2), to: whole ? "" : to.toFixed(2) });
  }
}
