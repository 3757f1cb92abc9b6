/**
 * A second clip beside the open one, in step with it: its chosen time coincides with the in point of the first.
 */

import * as api from "./api.js";
import { byId, el } from "./dom.js";
import { go, link, read } from "./state.js";
import { selected } from "./tray.js";

const SIMILAR = 8; // clips that are offered beside the results

export class Compare {
  /**
   * @param {import("./stage.js").Stage | null} stage @param {import("./stage.js").View | null} first
   * @param {() => import("./api.js").Hit[]} results that are offered to compare with
   */
  constructor(stage, first, results) {
    Object.assign(this, { first, results, clip: "", offered: "", from: 0, start: 0 });
    this.view = stage?.add(byId("second")) ?? null;
    if (this.view && first) [this.view.twin, first.twin] = [first, this.view];
    byId("compare").addEventListener("click", () => (read().with ? this.#leave() : this.#begin()));
    byId("compare-close").addEventListener("click", () => this.#leave());
    byId("compare-with").addEventListener("change", () => {
      const [clip, start] = byId("compare-with").value.split("@");
      go({ with: clip, c: start }, { quietly: true });
    });
    byId("shift").addEventListener("input", () => go({ c: String(Number(byId("shift").value)) }, { quietly: true }));
  }

  /** Show the second clip of a state. @param {import("./state.js").State} state @param {number} from the in point of the first */
  async show(state, from) {
    const clip = state.with;
    byId("second-box").hidden = !clip;
    byId("compare").setAttribute("aria-pressed", String(Boolean(clip)));
    if (!clip) return this.clear();
    this.from = from;
    if (clip !== this.clip) {
      this.clip = clip;
      byId("second-title").textContent = "Loading…";
      if (this.view) this.view.motion = null;
      this.#offer(state);
      try {
        const [info, motion] = await Promise.all([api.motion(clip), api.joints(clip)]);
        if (clip !== this.clip) return;
        byId("second-title").replaceChildren(el("a", { href: link({ clip, a: "", b: "", with: "", c: "", ask: [] }), title: info.path }, info.name));
        byId("shift").max = motion.end.toFixed(2);
        this.view?.show(motion);
        if (this.first?.motion && this.view) Object.assign(this.view, { zoom: this.first.zoom, pitch: this.first.pitch });
      } catch (error) {
        if (clip === this.clip) byId("second-title").textContent = /** @type {Error} */ (error).message;
        return;
      }
    }
    this.start = Number(read().c) || this.view?.motion?.start || 0;
    if (document.activeElement !== byId("shift")) byId("shift").value = String(this.start);
    this.seek(this.first?.time ?? from);
  }

  clear() {
    this.clip = this.offered = "";
    byId("second-box").hidden = true;
    byId("compare").setAttribute("aria-pressed", "false");
    if (this.view) this.view.motion = null;
  }

  /** Keep in step with the first. @param {number} time of the first */
  seek(time) {
    if (this.view?.motion) this.view.seek(this.start + time - this.from);
  }

  /** Compare with the best of what is offered. */
  async #begin() {
    const [best] = await this.#offer(read());
    if (best) go({ with: String(best.clip), c: best.start.toFixed(2) }, { quietly: true });
  }

  #leave() {
    go({ with: "", c: "" }, { quietly: true });
    byId("compare").focus();
  }

  /** Offer what is selected, the results, and what is similar. @param {import("./state.js").State} state @returns {Promise<import("./api.js").Hit[]>} */
  async #offer(state) {
    const results = this.results().filter((hit) => String(hit.clip) !== state.clip);
    const { hits } = await api.similar(state.clip, state.a, state.b, {}, SIMILAR, 0).catch(() => ({ hits: [] }));
    const similar = hits.filter((hit) => String(hit.clip) !== state.clip);
    const picked = selected().filter(({ clip }) => String(clip) !== state.clip).map((item) => /** @type {any} */ ({ ...item, start: item.start ?? 0 }));
    const groups = /** @type {[string, import("./api.js").Hit[]][]} */ ([["Selected", picked], ["Results", results], ["Most similar", similar]]);
    const option = (/** @type {import("./api.js").Hit} */ hit) => el("option", { value: `${hit.clip}@${hit.start.toFixed(2)}` }, hit.path);
    const offered = [...picked, ...results, ...similar];
    const known = offered.some((hit) => String(hit.clip) === state.with);
    byId("compare-with").replaceChildren(
      ...(state.with && !known ? [el("option", { value: `${state.with}@${state.c}` }, `#${state.with}`)] : []),
      ...groups.filter(([, hits]) => hits.length).map(([label, hits]) => el("optgroup", { label }, ...hits.map(option))),
    );
    const chosen = [...byId("compare-with").options].find(({ value }) => value.split("@")[0] === state.with);
    if (chosen) byId("compare-with").value = chosen.value;
    return offered;
  }
}
