/**
 * Composing: sentences on a time line become one motion, which plays above it; every change composes anew.
 */

import * as api from "./api.js";
import { byId, clamp, clock, el } from "./dom.js";
import { Line, SHORTEST } from "./line.js";
import { filters, link, note, read } from "./state.js";

const SETTLE = 350; // milliseconds without a change before a motion is composed
const NEW = 4; // seconds of a new sentence
const MOST = 40; // sentences
const PARTS = ["legs", "spine", "head", "left arm", "right arm"];

/** @typedef {import("./line.js").Sentence} Sentence */

export class Composer {
  /** @param {import("./stage.js").Stage | null} stage @param {() => boolean} isPlaying whether motions play when they come */
  constructor(stage, isPlaying) {
    Object.assign(this, { isPlaying, shown: "", asked: "", waiting: 0, asking: new AbortController(), selected: 0 });
    /** @type {Sentence[]} */
    this.sentences = [];
    /** @type {import("./api.js").Composition | null} */
    this.made = null;
    this.view = stage?.add(byId("composed")) ?? null;
    if (this.view) this.view.onTime = () => this.#showTime();
    this.line = new Line(byId("line"), {
      onChange: (sentences, done) => this.#change(sentences, done),
      onSelect: (i) => this.#select(i),
      onRemove: (i) => this.#remove(i),
      onOpen: () => byId("sentence").focus(),
      onSeek: (time) => this.view?.motion && this.view.seek(time),
    });
    byId("composed-play").addEventListener("click", () => this.toggle());
    byId("composed-loop").addEventListener("change", () => this.view && (this.view.loop = byId("composed-loop").checked));
    byId("add-sentence").addEventListener("submit", (/** @type {SubmitEvent} */ event) => {
      event.preventDefault();
      this.#add(byId("new-sentence").value.trim(), event.submitter?.id === "add-over");
    });
    byId("sentence-form").addEventListener("submit", (/** @type {Event} */ event) => event.preventDefault());
    byId("sentence-form").addEventListener("change", () => this.#edit());
    byId("sentence-remove").addEventListener("click", () => this.#remove(this.selected));
    byId("next-best").addEventListener("click", () => this.#nextBest());
    byId("choose-anew").addEventListener("click", () => this.#change(this.sentences.map((one) => ({ ...one, clip: null, at: null })), true));
    byId("composed-export").addEventListener("click", () => this.#export());
  }

  /** @param {import("./state.js").State} state */
  show(state) {
    if (state.line !== this.shown) {
      this.shown = state.line;
      this.sentences = parsed(state.line);
      this.selected = clamp(this.selected, 0, Math.max(this.sentences.length - 1, 0));
    }
    this.#draw();
    this.#ask();
  }

  /** Another view is shown. */
  close() {
    if (this.view) this.view.playing = false;
    this.#showTime();
  }

  /** Play or pause. */
  toggle() {
    if (!this.view?.motion) return;
    if (!this.view.playing && this.view.time >= this.view.to) this.view.seek(this.view.from);
    this.view.playing = !this.view.playing;
    this.#showTime();
  }

  /** @param {Sentence[]} sentences @param {boolean} done whether the change has ended, as a drag does */
  #change(sentences, done) {
    const chosen = this.sentences[this.selected];
    const id = chosen?.id;
    this.sentences = done ? ordered(sentences) : sentences;
    this.selected = Math.max(this.sentences.findIndex((one) => one.id === id), 0);
    this.#draw();
    if (!done) return;
    this.#note();
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => this.#ask(), SETTLE);
  }

  /** Keep the sentences in the URL fragment. */
  #note() {
    this.shown = written(this.sentences);
    note({ line: this.shown });
  }

  #question() {
    return JSON.stringify([this.shown, filters(read())]);
  }

  /** @param {number} i */
  #select(i) {
    if (i === this.selected) return;
    this.selected = i;
    this.#draw();
  }

  /** Add a sentence after the last, or over what is there at the play head. @param {string} text @param {boolean} over */
  #add(text, over) {
    if (!text || this.sentences.length >= MOST) return;
    byId("new-sentence").value = "";
    const end = Math.max(0, ...this.sentences.map((one) => one.end));
    const at = over && end ? round(clamp(this.view?.time ?? 0, 0, Math.max(end - NEW, 0))) : end;
    const added = { id: newId(), text, start: at, end: round(over && end ? Math.min(at + NEW, end) : at + NEW), parts: [], clip: null, at: null };
    this.#change([...this.sentences, added], true);
    this.#select(this.sentences.findIndex((one) => one.id === added.id));
  }

  /** @param {number} i */
  #remove(i) {
    this.#change(this.sentences.filter((_, at) => at !== i), true);
    byId(this.sentences.length ? "line" : "new-sentence").focus();
  }

  /** Take what the form of the selected sentence says. */
  #edit() {
    const one = this.sentences[this.selected];
    if (!one) return;
    const text = byId("sentence").value.trim() || one.text;
    const start = round(Math.max(Number(byId("sentence-start").value) || 0, 0));
    const end = Math.max(round(Number(byId("sentence-end").value) || 0), start + SHORTEST);
    const parts = PARTS.filter((_, i) => byId(`part-${i}`).checked);
    const pin = text === one.text ? {} : { clip: null, at: null };
    this.#change(this.sentences.map((other) => (other === one ? { ...one, text, start, end, parts, ...pin } : other)), true);
  }

  /** Show the selected sentence by a clip. @param {import("./api.js").Option} option */
  #pin(option) {
    this.#change(this.sentences.map((one, i) => (i === this.selected ? { ...one, clip: option.clip, at: middle(option) } : one)), true);
  }

  /** The option after the one that is shown. */
  #nextBest() {
    const own = this.made?.intervals[this.selected];
    if (!own?.options.length) return;
    const now = own.options.findIndex((option) => isShown(own, option));
    this.#pin(own.options[(now + 1) % own.options.length]);
  }

  /** Ask the server for the motion of the sentences, where it is not there yet. */
  async #ask() {
    const asked = this.#question();
    if (asked === this.asked) return;
    this.asked = asked;
    clearTimeout(this.waiting);
    this.asking.abort();
    this.asking = new AbortController();
    byId("composer-error").hidden = true;
    if (!this.sentences.length) {
      this.made = null;
      if (this.view) this.view.motion = null;
      byId("composer-status").textContent = "";
      return this.#draw();
    }
    byId("composer").setAttribute("aria-busy", "true");
    byId("composer-status").textContent = "Composing…";
    try {
      const made = await api.compose(this.sentences, filters(read()), this.asking.signal);
      this.#show(made);
    } catch (error) {
      if (error instanceof DOMException && error.name === "AbortError") return;
      this.asked = "";
      byId("composer-error").textContent = /** @type {Error} */ (error).message;
      byId("composer-error").hidden = false;
      byId("composer-status").textContent = this.made ? "The motion is that of before." : "";
    }
    byId("composer").setAttribute("aria-busy", "false");
  }

  /** @param {import("./api.js").Composition} made */
  #show(made) {
    this.made = made;
    // What is shown stays as it is while other sentences are changed.
    this.sentences = this.sentences.map((one, i) => ({ ...one, clip: made.intervals[i].clip, at: middle(made.intervals[i]) }));
    this.#note();
    this.asked = this.#question();
    byId("composer-status").textContent = `${clock(made.duration)} of ${new Set(made.intervals.map((one) => one.clip)).size} clips`;
    if (this.view) {
      const time = this.view.motion ? this.view.time : 0;
      const turned = this.view.motion && [this.view.yaw, this.view.zoom];
      this.view.show(made.motion);
      if (turned) [this.view.yaw, this.view.zoom] = turned;
      this.view.seek(time);
      if (!turned) this.view.playing = this.isPlaying();
    }
    this.#draw();
    this.#showTime();
  }

  #draw() {
    const shown = this.made?.intervals ?? [];
    this.line.draw(this.sentences, this.selected, (i) => (shown[i] && this.sentences[i].text === shown[i].text ? shown[i] : null));
    const one = this.sentences[this.selected];
    byId("composer").classList.toggle("empty", !one);
    if (!one) return;
    const own = shown[this.selected]?.text === one.text ? shown[this.selected] : null;
    for (const [id, value] of /** @type {[string, any][]} */ ([["sentence", one.text], ["sentence-start", one.start], ["sentence-end", one.end]])) byId(id).value = String(value);
    PARTS.forEach((part, i) => (byId(`part-${i}`).checked = one.parts.includes(part)));
    byId("parts-told").textContent = one.parts.length ? "" : own ? `by its words: ${own.parts.length === PARTS.length ? "whole body" : own.parts.join(", ")}` : "by its words";
    byId("next-best").disabled = !own || own.options.length < 2;
    const option = (/** @type {import("./api.js").Option} */ found) => {
      const name = found.path.split("/").pop();
      const span = `${found.source_start.toFixed(1)}–${found.source_end.toFixed(1)} s`;
      return el("li", {},
        el("button", { type: "button", "aria-pressed": String(Boolean(own && isShown(own, found))), title: found.path, onclick: () => this.#pin(found) }, el("span", {}, name), el("small", {}, span), el("span", { class: "score" }, found.score.toFixed(2))),
        el("a", { href: link({ clip: String(found.clip), a: found.source_start.toFixed(2), b: found.source_end.toFixed(2) }), "aria-label": `Open ${name}`, title: "Open" }, "↗")); // prettier-ignore
    };
    byId("options").replaceChildren(...(own?.options ?? []).map(option));
    byId("fit").textContent = own ? `TMR-score ${own.tmr_score.toFixed(2)}` : "";
    byId("composed-credits").textContent = this.made?.credits ?? "";
    byId("composed-credits").hidden = !this.made?.credits;
  }

  #showTime() {
    const { view } = this;
    this.line.seek(view?.motion ? view.time : 0);
    byId("composed-time").textContent = view?.motion ? `${view.time.toFixed(2)} / ${view.to.toFixed(2)} s` : "";
    byId("composed-play").classList.toggle("playing", Boolean(view?.playing));
    byId("composed-play").setAttribute("aria-label", view?.playing ? "Pause" : "Play");
  }

  async #export() {
    if (!this.made) return;
    try {
      const format = byId("composed-format").value;
      const data = await api.composeFile(this.sentences, filters(read()), format);
      const address = URL.createObjectURL(data);
      el("a", { href: address, download: "composition.zip", "data-native": true }).click();
      setTimeout(() => URL.revokeObjectURL(address), 10_000);
    } catch (error) {
      byId("composer-status").textContent = /** @type {Error} */ (error).message;
    }
  }
}

/** @param {import("./api.js").ComposedInterval} own @param {import("./api.js").Option} option */
const isShown = (own, option) => own.clip === option.clip && own.source_start === option.source_start && own.source_end === option.source_end;

/** @param {{source_start: number, source_end: number}} span */
const middle = ({ source_start, source_end }) => Number(((source_start + source_end) / 2).toFixed(2));

const round = (/** @type {number} */ seconds) => Math.round(10 * seconds) / 10;

let ids = 0;
const newId = () => ++ids;

/** As the server orders them, the first at 0. @param {Sentence[]} sentences */
function ordered(sentences) {
  const first = Math.min(...sentences.map((one) => one.start));
  return sentences.map((one) => ({ ...one, start: round(one.start - first), end: round(one.end - first) })).sort((a, b) => a.start - b.start || b.end - a.end);
}

/** Sentences as the fragment has them. @param {Sentence[]} sentences */
const written = (sentences) => (sentences.length ? JSON.stringify(sentences.map(({ text, start, end, parts, clip, at }) => [text, start, end, parts, clip, at])) : "");

/** @param {string} line @returns {Sentence[]} those that can be read */
function parsed(line) {
  try {
    const rows = /** @type {any[][]} */ (JSON.parse(line || "[]"));
    const found = rows.slice(0, MOST).map(([text, start, end, parts, clip, at]) => ({
      id: newId(), text: String(text ?? ""), start: Number(start), end: Number(end), parts: PARTS.filter((part) => (parts ?? []).includes(part)),
      clip: Number.isInteger(clip) ? clip : null, at: Number.isFinite(at) ? at : null,
    })); // prettier-ignore
    return ordered(found.filter((one) => one.text && one.end > one.start));
  } catch {
    return []; // not a line of this page
  }
}
