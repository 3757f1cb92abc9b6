/**
 * Results as a grid of moving figures.
 */

import * as api from "./api.js";
import { byId, clock, el, strengthMark, svg } from "./dom.js";
import { link } from "./state.js";
import { labels, tools } from "./tray.js";

const MAX_SECONDS = 10; // that a card plays
const POSTER = 0.4; // fraction of the span whose pose is shown while paused

export class Grid {
  /** @param {import("./stage.js").Stage | null} stage @param {HTMLElement} list @param {() => boolean} isPlaying */
  constructor(stage, list, isPlaying) {
    Object.assign(this, { stage, list, isPlaying });
    /** @type {{card: HTMLElement, view: import("./stage.js").View | null}[]} */
    this.cards = [];
    /** The card that was focused or opened last. */
    this.last = 0;
    this.seen = new IntersectionObserver((entries) => {
      for (const entry of entries) if (entry.isIntersecting) this.#load(/** @type {HTMLElement} */ (entry.target));
    }, { rootMargin: "300px" }); // prettier-ignore
    list.addEventListener("keydown", (event) => this.#move(event));
    for (const event of ["focusin", "pointerdown", "click"]) list.addEventListener(event, ({ target }) => this.#touch(/** @type {Node} */ (target)), true);
  }

  /** @param {import("./api.js").Hit[]} hits */
  show(hits) {
    this.clear();
    this.add(hits);
  }

  /** @param {import("./api.js").Hit[]} hits @param {Element | null} [before] the item before which they come; at the end without */
  add(hits, before = null) {
    for (const hit of hits) {
      const figure = el("div", { class: "stage loading" });
      const card = this.#card(hit, figure);
      const view = this.stage?.add(figure) ?? null;
      const at = before ? [...this.list.children].indexOf(before) : this.cards.length;
      this.cards.splice(at, 0, { card, view });
      card.addEventListener("pointerenter", () => this.#play(view, true));
      card.addEventListener("focus", () => this.#play(view, true));
      card.addEventListener("pointerleave", () => this.#play(view, this.isPlaying()));
      card.addEventListener("blur", () => this.#play(view, this.isPlaying()));
      Object.assign(card, { motionseek: { hit, view, figure } });
      this.#place(card, hit, before);
      this.seen.observe(card);
    }
  }

  clear() {
    this.seen.disconnect();
    for (const { view } of this.cards) view?.remove();
    this.cards = [];
    this.last = 0;
    this.list.replaceChildren();
  }

  /** A card is used: it opens under the question of now, which may be newer than the card. @param {Node} target */
  #touch(target) {
    const i = this.cards.findIndex(({ card }) => card.contains(target));
    if (i < 0) return;
    this.last = i;
    const { card } = this.cards[i];
    /** @type {HTMLAnchorElement} */ (card).href = opening(/** @type {any} */ (card).motionseek.hit);
  }

  /** Play or pause all figures. */
  refresh() {
    for (const { view } of this.cards) this.#play(view, this.isPlaying());
  }

  /** @returns {import("./api.js").Hit[]} */
  get hits() {
    return this.cards.map(({ card }) => /** @type {any} */ (card).motionseek.hit);
  }

  /** The hit of the focused card. @returns {import("./api.js").Hit | null} */
  get focused() {
    const card = document.activeElement?.closest?.(".card");
    return card && this.list.contains(card) ? /** @type {any} */ (card).motionseek.hit : null;
  }

  /** @param {number} i the number of a card */
  focus(i) {
    this.cards[i]?.card.focus();
  }

  #play(view, playing) {
    if (view) view.playing = playing;
  }

  #place(card, hit, before) {
    const item = el("li", {}, card, tools(hit));
    this.list.insertBefore(item, before);
    this.#offerCopies(item, hit);
  }

  /** Say how many clips a card stands for, as more hits came. */
  refreshCopies() {
    for (const { card } of this.cards) this.#offerCopies(card.parentElement, /** @type {any} */ (card).motionseek.hit);
  }

  /** A button that shows the other clips of a stack. */
  #offerCopies(item, hit) {
    item.querySelector(".copies")?.remove();
    if (!hit.copies?.length) return;
    const button = el("button", { type: "button", class: "copies", onclick: () => {
      const next = item.nextElementSibling;
      const copies = hit.copies.splice(0);
      button.remove();
      this.add(copies, next);
      /** @type {HTMLElement} */ (item.nextElementSibling?.firstElementChild)?.focus();
    } }, `${hit.copies.length} more of this performance`); // prettier-ignore
    item.append(button);
  }

  /** @param {import("./api.js").Hit} hit @param {HTMLElement} figure */
  #card(hit, figure) {
    const title = hit.caption || hit.path.split("/").pop()?.replace(/\.[^.]*$/, "") || "";
    const span = isWhole(hit) ? "whole clip" : `${hit.start.toFixed(1)}–${hit.end.toFixed(1)} s`;
    return el(
      "a",
      { class: `card ${hit.strength}`, href: opening(hit), draggable: "false" },
      figure,
      el(
        "div",
        { class: "legend" },
        hit.score === undefined
          ? null
          : el("p", { class: "rating" }, strengthMark(hit.strength), el("span", { class: "score", title: "cosine similarity" }, hit.score.toFixed(2))),
        el("h2", { class: "title" }, title),
        el("p", { class: "file", title: hit.path }, hit.path),
        el("p", { class: "facts", title: frames(hit) }, `${clock(hit.duration)} · ${span}`),
        labels(hit),
        hit.steps ? steps(hit) : null,
      ),
    );
  }

  /** @param {HTMLElement} card */
  async #load(card) {
    this.seen.unobserve(card);
    const { hit, view, figure } = /** @type {any} */ (card).motionseek;
    try {
      const motion = await api.joints(hit.clip, hit.start, Math.min(hit.end, hit.start + MAX_SECONDS));
      figure.classList.remove("loading");
      if (!view || !this.stage?.views.has(view)) return;
      view.show(motion);
      view.seek(motion.start + POSTER * (motion.end - motion.start));
      view.playing = this.isPlaying();
    } catch (error) {
      figure.classList.replace("loading", "failed");
      figure.replaceChildren(el("p", {}, /** @type {Error} */ (error).message));
    }
  }

  /** Arrow keys move the focus between cards. @param {KeyboardEvent} event */
  #move(event) {
    const at = this.cards.findIndex(({ card }) => card === document.activeElement);
    const columns = getComputedStyle(this.list).gridTemplateColumns.split(" ").length;
    const step = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -columns, ArrowDown: columns, Home: -at, End: this.cards.length - 1 - at }[event.key];
    if (at < 0 || step === undefined || event.metaKey || event.ctrlKey || event.altKey) return;
    event.preventDefault();
    const next = this.cards[at + step];
    if (next) next.card.focus();
    else if (at + step < 0) byId("q").focus();
  }
}

const isWhole = (/** @type {import("./api.js").Hit} */ hit) => hit.end - hit.start >= hit.duration - 0.05;

/** The link that opens a hit. @param {import("./api.js").Hit} hit */
const opening = (hit) => link({ clip: String(hit.clip), a: isWhole(hit) ? "" : hit.start.toFixed(2), b: isWhole(hit) ? "" : hit.end.toFixed(2), with: "", c: "", ask: [] });

/** The steps of a hit as parts of its span, and in words. @param {import("./api.js").Hit} hit */
function steps(hit) {
  const length = hit.end - hit.start;
  const bars = hit.steps.map(({ start, end }, i) =>
    svg("rect", { x: (100 * (start - hit.start)) / length, y: 0, width: Math.max((100 * (end - start)) / length, 1), height: 6, class: `s${i % 6}` }),
  );
  return el("div", { class: "steps" },
    svg("svg", { viewBox: "0 0 100 6", preserveAspectRatio: "none", "aria-hidden": "true" }, ...bars),
    el("ol", {}, ...hit.steps.map(({ text, start, end }, i) => el("li", {}, el("span", { class: `swatch s${i % 6}`, "aria-hidden": "true" }), `${text} ${start.toFixed(1)}–${end.toFixed(1)} s`)))); // prettier-ignore
}

/** The frames of the file that a hit covers, and what became of it, as text. @param {import("./api.js").Hit} hit */
const frames = (hit) => {
  const covered = hit.source_fps ? `frames ${hit.first_frame}–${hit.last_frame} of the file, at ${+hit.source_fps.toFixed(2)} fps` : "";
  return [covered, hit.stale ? `the file ${hit.stale}` : ""].filter(Boolean).join("; ");
};
