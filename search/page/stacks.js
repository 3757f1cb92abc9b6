/**
 * Stacks: clips that show one performance are one card, which opens. Where a side is asked for, mirrored ones stay apart.
 */

import * as api from "./api.js";

const SIDES = /\b(left|right|clockwise|anti-?clockwise|counter-?clockwise)(wards?)?\b/i;
const AGAIN = 2000; // milliseconds until it is asked again for stacks that are being found

/** @type {Map<number, {key: number, mirrored: boolean, size: number}>} by the number of a clip */
let stacks = new Map();

/** Whether a question asks for a side or a direction of turning. @param {string} q */
export const asksSide = (q) => SIDES.test(q);

/** Read the stacks, now or once they are found. @param {() => void} changed called when they are there */
export async function readStacks(changed) {
  const found = await api.stacks().catch(() => null);
  if (found && !found.stacks) return void setTimeout(readStacks, AGAIN, changed);
  if (!found) return;
  stacks = new Map();
  for (const stack of found.stacks) {
    const sizes = [false, true].map((side) => stack.filter(([, mirrored]) => mirrored === side).length);
    for (const [clip, mirrored] of stack) stacks.set(clip, { key: stack[0][0], mirrored, size: stack.length, sides: sizes[Number(mirrored)] });
  }
  if (stacks.size) changed();
}

/** Whether hits that are shown may belong together. @param {import("./api.js").Hit[]} hits */
export const areStacked = (hits) => hits.filter(({ clip }) => stacks.has(/** @type {number} */ (clip))).length > 1;

/**
 * The first hit of each stack, with those that it stands for as `copies`.
 * @param {import("./api.js").Hit[]} hits @param {boolean} sided @param {Map<string, import("./api.js").Hit>} seen the first hits of stacks so far
 */
export function stacked(hits, sided, seen) {
  return hits.filter((hit) => {
    const stack = stacks.get(/** @type {number} */ (hit.clip));
    if (!stack) return true;
    const key = sided ? `${stack.key} ${stack.mirrored}` : String(stack.key);
    const first = seen.get(key);
    if (!first) {
      seen.set(key, Object.assign(hit, { copies: [] }));
      return true;
    }
    if (first.clip === hit.clip) return true; // another moment of the same clip
    /** @type {any} */ (first).copies.push(Object.assign(hit, { mirrored: stack.mirrored !== stacks.get(/** @type {number} */ (first.clip))?.mirrored }));
    return false;
  });
}
