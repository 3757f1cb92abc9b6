/**
 * The server's routes as functions. Answers are plain objects as docs/serving.md describes them.
 */

import { Motion } from "./motion.js";

/**
 * @typedef {{rank: number, path: string, score: number, strength: string, start: number, end: number,
 *   duration: number, caption: string, clip: number | string}} Hit
 * @typedef {{text: string, start: number | null, end: number | null}} Caption
 * @typedef {{clip: number | string, path: string, name: string, duration: number, fps: number, frames: number,
 *   format: string, rig: string, added: string, captions?: Caption[]}} MotionInfo
 * @typedef {{generation: number, clips: number[], x: number[], y: number[], labels: string[], label: number[]}} MapData
 */

/** What the server would not do, in its own words. */
export class ApiError extends Error {
  /** @param {string} message @param {number} status */
  constructor(message, status) {
    super(message);
    this.status = status;
  }
}

/**
 * @param {string} route
 * @param {Record<string, any>} [parameters] arrays are given several times, empty ones left out
 */
function address(route, parameters = {}) {
  const query = new URLSearchParams();
  for (const [name, value] of Object.entries(parameters))
    for (const one of Array.isArray(value) ? value : [value])
      if (one !== undefined && one !== null && one !== "") query.append(name, String(one));
  return `api/${route}${query.size ? `?${query}` : ""}`;
}

/** @param {string} url @param {RequestInit} [options] */
async function ask(url, options) {
  let response;
  try {
    response = await fetch(url, options);
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    throw new ApiError("The server does not answer. Is motionseek serve still running?", 0);
  }
  if (response.ok) return response;
  const said = await response.json().catch(() => ({}));
  throw new ApiError(said.error ?? `The server answered ${response.status}.`, response.status);
}

/** @param {string} url @param {RequestInit} [options] */
const askJson = async (url, options) => (await ask(url, options)).json();

/** @param {AbortSignal} [signal] @returns {Promise<{query: string, hits: Hit[]}>} */
export const search = (q, filters, k, offset, signal) => askJson(address("search", { q, k, offset, ...filters }), { signal });

/** Moments of the whole library. @param {AbortSignal} [signal] @returns {Promise<{hits: Hit[]}>} */
export const moments = (q, filters, k, offset, signal) => askJson(address("moments", { q, k, offset, ...filters }), { signal });

/**
 * Moments of one clip, and how alike it is to the sentence over time.
 * @returns {Promise<{hits: Hit[], curve: {times: number[], similarity: Record<string, number[]>}}>}
 */
export const momentsIn = (clip, q, k) => askJson(address("moments", { clip, q, k, split: false }));

/** @returns {Promise<{sentences: {text: string, score: number}[]}>} */
export const describe = (clip, start, end, k = 5) => askJson(address("describe", { clip, start, end, k }));

/** @param {AbortSignal} [signal] @returns {Promise<{query: string, hits: Hit[]}>} */
export const similar = (clip, start, end, filters, k, offset, signal) =>
  askJson(address("similar", { clip, start, end, k, offset, ...filters }), { signal });

/** @param {AbortSignal} [signal] @returns {Promise<{total: number, motions: MotionInfo[]}>} */
export const motions = (filters, limit, offset, signal) => askJson(address("motions", { limit, offset, ...filters }), { signal });

/** @returns {Promise<MotionInfo>} */
export const motion = (clip) => askJson(address(`motions/${clip}`));

/** @returns {Promise<MapData>} */
export const map = () => askJson(address("map"));

/** @returns {Promise<Record<string, any>>} */
export const stats = () => askJson(address("stats"));

/** Hand a file over; the answer's `clip` names it from then on. @param {File} file @returns {Promise<{clip: string}>} */
export const upload = (file) => askJson(address("describe", { name: file.name }), { method: "POST", body: file });

/** Where a cut is downloaded. */
export const exportAddress = (clip, start, end, format) => address("export", { clip, start, end, format });

const KEPT = 96;
/** @type {Map<string, Promise<Motion>>} the last motions fetched, oldest first */
const kept = new Map();

/**
 * The joints of a span, fetched once.
 * @param {number | string} clip @param {number} [start] @param {number} [end] @param {number} [fps]
 * @returns {Promise<Motion>}
 */
export function joints(clip, start, end, fps = 20) {
  const url = address(`motions/${clip}/joints`, { start, end, fps });
  const found = kept.get(url) ?? ask(url).then(async (response) => new Motion(await response.arrayBuffer()));
  kept.delete(url);
  kept.set(url, found);
  found.catch(() => kept.delete(url));
  if (kept.size > KEPT) kept.delete(/** @type {string} */ (kept.keys().next().value));
  return found;
}
