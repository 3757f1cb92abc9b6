/**
 * Runs the query of the state and shows its hits; a response that arrives after a newer query is dropped.
 */

import * as api from "./api.js";
import { byId, clamp, clock, el } from "./dom.js";
import { asksSide, stacked } from "./stacks.js";
import { asked, clipsOf, filters, go, likeness, link } from "./state.js";

const PAGE = 24;
const MOST = 200; // hits of one request
const MAX_OFFSET = 200; // of moments and similar clips
const SLOW = 150; // milliseconds until it is said what takes so long
const ORDERS = {
  name: (a, b) => a.path.localeCompare(b.path, undefined, { numeric: true }),
  longest: (a, b) => b.duration - a.duration,
  shortest: (a, b) => a.duration - b.duration,
};
const SUGGESTIONS = ["a person walks forward", "someone waves with the right hand", "running and then jumping", "a person kicks a ball", "sits down on a chair", "climbs up a ladder"];

/** Of the choice that is shown where nothing is asked: another one at each visit. */
let seed = crypto.getRandomValues(new Uint16Array(1))[0];

export class Results {
  /** @param {import("./grid.js").Grid} grid */
  constructor(grid) {
    this.grid = grid;
    this.asked = "";
    this.running = new AbortController();
    this.offset = 0;
    byId("more").addEventListener("click", () => this.#more());
    byId("others").addEventListener("click", () => {
      seed = (seed + 1) % 2 ** 16;
      this.asked = "";
      this.show(this.state);
    });
    byId("weaker").addEventListener("click", () => go({ strength: "weak" }));
    byId("sort").addEventListener("change", () => go({ sort: byId("sort").value }, { quietly: true }));
    byId("chips").replaceChildren(...SUGGESTIONS.map((q) => el("a", { class: "chip", href: link({ q }), "data-q": q }, q)));
  }

  /** @param {import("./state.js").State} state @param {number} [count] of hits that were shown when the user left */
  async show(state, count = PAGE) {
    const key = JSON.stringify([state.q, state.moments, state.like, state.from, state.to, state.ids, state.sort, asked(state)]);
    if (key === this.asked) return;
    this.asked = key;
    this.state = state;
    const wanted = clamp(count, PAGE, MOST);
    this.running.abort();
    this.running = new AbortController();
    this.offset = 0;
    this.#loading(true);
    byId("more-error").textContent = "";
    byId("chips").hidden = Boolean(state.q || state.like || state.ids);
    byId("others").hidden = true;
    byId("sort").value = state.sort;
    byId("sort").options[0].text = state.q || state.like ? "Best first" : "Varied";
    byId("sort").querySelector("[value=newest]").hidden = !isListing(state); // a hit does not say when it was added
    byId("recent-chips").classList.toggle("unasked", !byId("chips").hidden);
    for (const chip of byId("chips").children) chip.href = link({ q: chip.dataset.q, view: "", clip: "" });
    const { signal } = this.running;
    const waiting = setTimeout(() => this.#wait(state), SLOW);
    signal.addEventListener("abort", () => clearTimeout(waiting));
    try {
      const { hits, message, total } = await answer(state, 0, wanted, signal);
      if (signal.aborted) return;
      this.seen = new Map();
      this.hits = hits;
      this.grid.show(this.#sorted(hits));
      this.#report(state, hits, message);
      this.#offerMore(hits.length, wanted, total);
    } catch (error) {
      if (signal.aborted) return;
      this.asked = "";
      this.grid.clear();
      byId("status").textContent = "";
      byId("more").hidden = byId("weaker").hidden = true;
      this.#notice("Request failed", /** @type {Error} */ (error).message, el("button", { type: "button", onclick: () => this.show(state) }, "Try again"));
    } finally {
      clearTimeout(waiting);
    }
    this.#loading(false);
  }

  async #more() {
    const { signal } = this.running;
    byId("more").disabled = true;
    byId("more-error").textContent = "";
    try {
      const { hits, total } = await answer(this.state, this.offset, PAGE, signal);
      if (signal.aborted) return;
      const before = this.grid.cards.length;
      this.hits = [...this.hits, ...hits];
      if (this.state.sort && !isListing(this.state)) {
        this.seen = new Map();
        this.grid.show(this.#sorted(this.hits));
      } else this.grid.add(this.#sorted(hits));
      this.grid.refreshCopies();
      this.grid.focus(before);
      this.#offerMore(hits.length, PAGE, total);
    } catch (error) {
      if (!signal.aborted) byId("more-error").textContent = /** @type {Error} */ (error).message;
    } finally {
      byId("more").disabled = false;
    }
  }

  /** Hits as cards, in the order that is asked for; the server sorts a listing. @param {any[]} hits */
  #sorted(hits) {
    const order = isListing(this.state) ? undefined : ORDERS[this.state.sort];
    return stacked(order ? [...hits].sort(order) : hits, asksSide(this.state.q), this.seen);
  }

  #offerMore(got, asked, total) {
    this.offset += got;
    byId("more").hidden = got < asked || this.offset >= total;
    const found = !isListing(this.state) && !this.state.ids && this.hits.some(({ strength }) => strength !== "weak");
    byId("weaker").hidden = !found || !byId("more").hidden || Boolean(this.state.strength);
    byId("others").hidden = byId("chips").hidden || Boolean(this.state.sort) || total <= PAGE;
  }

  /** @param {boolean} whether */
  #loading(whether) {
    byId("results").classList.toggle("busy", whether);
    byId("results").setAttribute("aria-busy", String(whether));
    if (!whether) byId("progress").hidden = true;
  }

  /** An answer takes its time: say what is being done. @param {import("./state.js").State} state */
  #wait(state) {
    byId("progress").hidden = false;
    byId("notice").hidden = true;
    byId("status").textContent = state.q && state.moments && !state.like ? `Looking for the exact moments of “${state.q}” in the whole library…` : "Searching…";
  }

  /** @param {import("./state.js").State} state @param {any[]} hits @param {string} message */
  #report(state, hits, message) {
    byId("notice").hidden = true;
    byId("status").textContent = message;
    const filtered = Object.values(asked(state)).some(Boolean);
    if (!hits.length && filtered) {
      const clear = el("button", { type: "button", onclick: () => byId("filters").reset() }, "Clear the filters");
      this.#notice("Nothing passes the filters", "No clip meets all of them.", clear);
    } else if (!hits.length && state.ids) this.#notice("Gone", "The selected clips are no longer there. Files that were dropped are kept for a while only: drop them again.");
    else if (!hits.length && !state.q && !state.like) {
      byId("chips").hidden = true;
      this.#notice("Nothing is indexed yet", "Index a folder of motion capture in a terminal; what it finds appears here by itself:", el("code", {}, "motionseek index my_mocap/"), el("p", { class: "after" }, "Or drop motion files or a folder on this page to see what they are."));
    } else if (!hits.length) this.#notice("Nothing found", "There are no clips to show.");
    else if (state.q && hits.every((hit) => hit.strength === "weak" && !hit.matched?.length))
      this.#notice("No good match", `The clips nearest to “${state.q}” are all weak matches. Try plainer words: what the body does, with which hand or foot, in which direction.`);
  }

  #notice(title, text, ...rest) {
    byId("notice").hidden = false;
    byId("notice").replaceChildren(el("h2", {}, title), el("p", {}, text), ...rest);
  }
}

/**
 * @param {import("./state.js").State} state @param {number} offset @param {number} count @param {AbortSignal} signal
 * @returns {Promise<{hits: import("./api.js").Hit[], message: string, total: number}>} total: Infinity where not known
 */
async function answer(state, offset, count, signal) {
  const given = asked(state);
  if (state.ids) return selected(state, offset, count, signal);
  if (state.like && !state.q) {
    const { hits, query } = await api.similar(state.like, state.from, state.to, given, count, offset, signal);
    return { hits, message: hits.length ? `Similar to ${query}` : `Nothing is like ${query}`, total: MAX_OFFSET };
  }
  if (state.q && state.moments && !state.like) {
    const { hits, sentences, how, language, without } = await api.moments(state.q, given, count, offset, signal);
    const steps = sentences ? ` (${sentences.length} steps, ${how === "while" ? "at the same time" : "one after the other"})` : "";
    return { hits, message: counted(hits, "moment", state.q, count) + steps + understood(language, without), total: MAX_OFFSET };
  }
  if (state.q) {
    const { hits, language, without } = await api.search(state.q, likeness(state), given, count, offset, signal);
    return { hits, message: counted(hits, "clip", state.q, count) + understood(language, without), total: Infinity };
  }
  const { motions, total } = await api.motions(filters(state), count, offset, state.sort ? { sort: state.sort } : { seed }, signal);
  const seconds = motions.reduce((sum, { duration }) => sum + duration, 0);
  const message = total > count ? `${state.sort ? "The first" : "A choice"} of ${plural(total, "clip")}` : total ? `${plural(total, "clip")}, ${clock(seconds)}` : "";
  return { hits: motions.map(whole), message, total };
}

/** Selected clips that pass the filters; uploads pass all. */
async function selected(state, offset, count, signal) {
  const all = clipsOf(state.ids);
  const filtered = Object.values(filters(state)).some(Boolean);
  const passing = filtered ? new Set((await api.clips(filters(state))).map(String)) : null;
  const clips = passing ? all.filter((clip) => clip.startsWith("u") || passing.has(clip)) : all;
  const motions = await api.motionsOf(clips.slice(offset, offset + count), signal);
  const passed = clips.length < all.length ? `${clips.length.toLocaleString("en")} of ${plural(all.length, "selected clip")} pass the filters` : `${plural(all.length, all[0]?.startsWith("u") ? "motion" : "clip")} ${all[0]?.startsWith("u") ? "of your files, not in the library" : "selected"}`;
  return { hits: motions.map(whole), message: passed, total: clips.length };
}

const plural = (/** @type {number} */ n, /** @type {string} */ thing) => `${n.toLocaleString("en")} ${thing}${n === 1 ? "" : "s"}`;

/** What is said of how a question was taken. @param {string | null | undefined} language @param {string[]} [without] */
const understood = (language, without = []) =>
  (language ? `, understood as ${language}` : "") + (without.length ? `, without ${without.map((text) => `“${text}”`).join(", ")}` : "");

/** @param {import("./api.js").Hit[]} hits @param {string} thing @param {string} q @param {number} asked how many were asked for */
function counted(hits, thing, q, asked) {
  const sure = hits.filter(({ strength, matched }) => strength === "strong" || strength === "plausible" || matched?.length).length;
  if (!hits.length) return `Nothing found for “${q}”`;
  const things = (/** @type {number} */ n) => plural(n, thing);
  if (sure && sure === hits.length) return `${things(sure)}${sure < asked ? "" : " or more"} for “${q}”`;
  if (sure) return `${things(sure)} for “${q}”, followed by weak matches`;
  return `The nearest ${things(hits.length)} to “${q}”`;
}

/** Whether clips are listed, without a question. @param {import("./state.js").State} state */
const isListing = (state) => !state.q && !state.like && !state.ids;

/** A whole clip as a hit without a score. @param {import("./api.js").MotionInfo} info */
const whole = (info) => /** @type {any} */ ({ clip: info.clip, path: info.path, start: info.start, end: info.start + info.duration, duration: info.duration, strength: "", caption: info.captions?.[0]?.text ?? "", starred: info.starred, tags: info.tags });
