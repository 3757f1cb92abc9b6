/**
 * The tracks of an open clip: for each sentence its similarity over time and its moments; a question for steps has one a step.
 */

import * as api from "./api.js";
import { read } from "./state.js";

const COLOURS = 6;
const [MIN_MOMENTS, MAX_MOMENTS] = [8, 200]; // of a track, one more a minute of the take

/** @typedef {Omit<import("./timeline.js").Track, "colour" | "removable">} Found */

export class Tracks {
  /** @param {import("./timeline.js").Timeline} timeline */
  constructor(timeline) {
    this.timeline = timeline;
    this.clear();
  }

  clear() {
    this.clip = "";
    /** @type {Map<string, Found[]>} question -> its tracks in the open clip; several where it has steps */
    this.found = new Map();
    /** @type {[string, boolean][]} questions, and whether their steps are looked for */
    this.questions = [];
    this.timeline.draw([]);
  }

  /** Request the tracks that are missing; each is drawn when it arrives. @param {import("./state.js").State} state @param {number} duration */
  show(state, duration) {
    const { clip } = state;
    this.clip = clip;
    const count = Math.min(MIN_MOMENTS + Math.floor(duration / 60), MAX_MOMENTS);
    const steps = Boolean(state.moments);
    this.questions = [...new Set([state.like ? "" : state.q, ...state.ask].filter(Boolean))].map((text) => [text, steps && text === state.q]);
    for (const [text, split] of this.questions) {
      const key = `${split} ${text}`;
      if (this.found.has(key)) continue;
      const blank = { text, times: [], similarity: [], moments: [], note: "looking…" };
      this.found.set(key, [blank]);
      api.momentsIn(clip, text, count, split).then((answer) => tracked(text, answer), (error) => [{ ...blank, note: error.message }])
        .then((tracks) => {
          if (clip !== this.clip) return;
          this.found.set(key, tracks);
          this.#draw();
        }); // prettier-ignore
    }
    this.#draw();
  }

  #draw() {
    const asked = read().ask;
    const tracks = this.questions.flatMap(([text, split]) => (this.found.get(`${split} ${text}`) ?? []).map((track) => ({ ...track, removable: asked.includes(text) && track.text === text })));
    this.timeline.draw(tracks.map((track, i) => ({ ...track, colour: i % COLOURS })));
  }
}

/** A response as tracks, one a step. @param {string} text @param {Awaited<ReturnType<typeof api.momentsIn>>} answer @returns {Found[]} */
function tracked(text, { hits, sentences, curve }) {
  const sure = hits.filter(({ strength }) => strength === "strong" || strength === "plausible");
  const shown = sure.length ? sure : hits.slice(0, 1);
  const note = sure.length ? `${sure.length} ${sure.length === 1 ? "moment" : "moments"}` : "weak match only";
  const similarity = (/** @type {string} */ sentence) => curve.similarity[sentence] ?? Object.values(curve.similarity)[0] ?? [];
  if (!sentences || sentences.length < 2) return [{ text, times: curve.times, similarity: similarity(text), moments: shown, note }];
  return sentences.map((sentence, i) => ({
    text: sentence,
    times: curve.times,
    similarity: similarity(sentence),
    moments: shown.flatMap((hit) => (hit.steps?.[i] ? [{ ...hit, ...hit.steps[i], strength: hit.strength }] : [])),
    note: i ? "" : `step 1 of ${sentences.length} · ${note}`,
  }));
}
