/**
 * Runs the query of the state and shows its hits; a response that arrives after a newer query is dropped.
 */

import * as api from "./api.js";
import { byId, clock, el } from "./dom.js";
import { filters, link } from "./state.js";

const PAGE = 24;
const MAX_OFFSET = 200; // of moments and similar clips
const SUGGESTIONS = ["a person walks forward", "someone waves with the right hand", "running and then jumping", "a person kicks a ball", "sits down on a chair", "climbs up a ladder", "dances happily"];

export class Results {
  /** @param {import("./grid.js").Grid} grid */
  constructor(grid) {
    this.grid = grid;
    this.asked = "";
    this.running = new AbortController();
    this.offset = 0;
    byId("more").addEventListener("click", () => this.#more());
    byId("chips").replaceChildren(...SUGGESTIONS.map((q) => el("a", { class: "chip", href: link({ q }), "data-q": q }, q)));
  }

  /** @param {import("./state.js").State} state */
  async show(state) {
    const key = JSON.stringify([state.q, state.moments, state.like, state.from, state.to, state.ids, filters(state)]);
    if (key === this.asked) return;
    this.asked = key;
    this.state = state;
    this.running.abort();
    this.running = new AbortController();
    this.offset = 0;
    this.#loading(true);
    byId("chips").hidden = Boolean(state.q || state.like || state.ids);
    for (const chip of byId("chips").children) chip.href = link({ q: chip.dataset.q, view: "", clip: "" });
    try {
      const { signal } = this.running;
      const { hits, message, total } = await answer(state, 0, signal);
      if (signal.aborted) return;
      this.grid.show(hits);
      this.#report(state, hits, message);
      this.#offerMore(hits.length, total);
    } catch (error) {
      if (error instanceof DOMException && error.name === "AbortError") return;
      this.asked = "";
      this.grid.clear();
      byId("status").textContent = "";
      byId("more").hidden = true;
      this.#notice("Request failed", /** @type {Error} */ (error).message, el("button", { type: "button", onclick: () => this.show(state) }, "Try again"));
    }
    this.#loading(false);
  }

  async #more() {
    const { signal } = this.running;
    const { hits, total } = await answer(this.state, this.offset, signal).catch(() => ({ hits: [], total: 0 }));
    if (signal.aborted) return;
    this.grid.add(hits);
    this.grid.cards[this.offset]?.card.focus();
    this.#offerMore(hits.length, total);
  }

  #offerMore(got, total) {
    this.offset += got;
    byId("more").hidden = got < PAGE || this.offset >= total;
  }

  /** @param {boolean} whether */
  #loading(whether) {
    byId("results").classList.toggle("busy", whether);
    byId("results").setAttribute("aria-busy", String(whether));
  }

  /** @param {import("./state.js").State} state @param {any[]} hits @param {string} message */
  #report(state, hits, message) {
    byId("notice").hidden = true;
    byId("status").textContent = message;
    const filtered = Object.values(filters(state)).some(Boolean);
    if (!hits.length && !state.q && !state.like && !filtered)
      this.#notice("This library is empty", "Index a folder of motion capture:", el("code", {}, "motionseek index my_mocap/"));
    else if (!hits.length) this.#notice("Nothing found", filtered ? "No clip passes the filters. Change or clear them." : "There are no clips to show.");
    else if (state.q && hits.every((hit) => hit.strength === "weak"))
      this.#notice("No good match", `The clips nearest to “${state.q}” are all weak matches. Try plainer words: what the body does, with which hand or foot, in which direction.`);
  }

  #notice(title, text, ...rest) {
    byId("notice").hidden = false;
    byId("notice").replaceChildren(el("h2", {}, title), el("p", {}, text), ...rest);
  }
}

/**
 * @param {import("./state.js").State} state @param {number} offset @param {AbortSignal} signal
 * @returns {Promise<{hits: import("./api.js").Hit[], message: string, total: number}>} total: Infinity where not known
 */
async function answer(state, offset, signal) {
  const given = filters(state);
  if (state.ids) {
    const ids = state.ids.split(",").slice(offset, offset + PAGE);
    const found = await Promise.all(ids.map((id) => api.motion(id).catch(() => null)));
    const hits = found.filter((info) => info !== null).map(whole);
    return { hits, message: `${state.ids.split(",").length} clips selected on the map`, total: state.ids.split(",").length };
  }
  if (state.like) {
    const { hits, query } = await api.similar(state.like, state.from, state.to, given, PAGE, offset, signal);
    const span = state.from ? ` from ${state.from} to ${state.to} s` : "";
    return { hits, message: `Similar to ${query}${span}`, total: MAX_OFFSET };
  }
  if (state.q && state.moments) {
    const { hits } = await api.moments(state.q, given, PAGE, offset, signal);
    return { hits, message: counted(hits, "moment", state.q), total: MAX_OFFSET };
  }
  if (state.q) {
    const { hits } = await api.search(state.q, given, PAGE, offset, signal);
    return { hits, message: counted(hits, "clip", state.q), total: Infinity };
  }
  const { motions, total } = await api.motions(given, PAGE, offset, signal);
  const seconds = motions.reduce((sum, { duration }) => sum + duration, 0);
  const message = total ? `${total} clips${total <= PAGE ? `, ${clock(seconds)}` : ""}. Describe the motion you are looking for.` : "";
  return { hits: motions.map(whole), message, total };
}

/** @param {import("./api.js").Hit[]} hits @param {string} thing @param {string} q */
function counted(hits, thing, q) {
  const sure = hits.filter(({ strength }) => strength === "strong" || strength === "plausible").length;
  const things = (/** @type {number} */ n) => `${n} ${thing}${n === 1 ? "" : "s"}`;
  if (sure && sure === hits.length) return `${things(sure)} or more for “${q}”`;
  if (sure) return `${things(sure)} for “${q}”, followed by weak matches`;
  return `The nearest ${things(hits.length)} to “${q}”`;
}

/** A whole clip as a hit without a score. @param {import("./api.js").MotionInfo} info */
const whole = (info) => /** @type {any} */ ({ clip: info.clip, path: info.path, start: info.start, end: info.start + info.duration, duration: info.duration, strength: "", caption: info.captions?.[0]?.text ?? "" });
