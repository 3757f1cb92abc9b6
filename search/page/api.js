/**
 * The server's routes as functions; responses are as in docs/serving.md.
 */

import { Motion } from "./motion.js";

/**
 * @typedef {{rank: number, path: string, score: number, strength: string, start: number, end: number,
 *   duration: number, caption: string, clip: number | string, root: string | null,
 *   source_fps: number | null, first_frame: number | null, last_frame: number | null,
 *   matched: string[], starred: boolean, tags: string[], collections: string[], copies?: Hit[], mirrored?: boolean,
 *   stale: string | null, steps?: {text: string, score: number, start: number, end: number}[]}} Hit
 * @typedef {{text: string, start: number | null, end: number | null}} Caption
 * @typedef {{clip: number | string, root: string | null, path: string, name: string, duration: number, fps: number, frames: number,
 *   format: string, rig: string, added: string, start: number, source_fps: number | null, source_frames: number | null, captions?: Caption[], starred: boolean, tags: string[]}} MotionInfo
 * @typedef {{clip: number, path: string, source_start: number, source_end: number, score: number}} Option
 * @typedef {{text: string, start: number, end: number, parts: string[], path: string, clip: number, source_start: number, source_end: number,
 *   tmr_score: number, options: Option[]}} ComposedInterval
 * @typedef {{duration: number, intervals: ComposedInterval[], joins: number[], credits: string | null, motion: Motion}} Composition
 * @typedef {{generation: number, clips: number[], x: number[], y: number[], labels: string[], label: number[]}} MapData
 */

/** An error response, with the server's message. */
export class ApiError extends Error {
  /** @param {string} message @param {number} status */
  constructor(message, status) {
    super(message);
    this.status = status;
  }
}

/**
 * @param {string} route
 * @param {Record<string, any>} [parameters] arrays are repeated, empty values left out
 */
function address(route, parameters = {}) {
  const query = new URLSearchParams();
  for (const [name, value] of Object.entries(parameters))
    for (const one of Array.isArray(value) ? value : [value])
      if (one !== undefined && one !== null && one !== "") query.append(name, String(one));
  return `api/${route}${query.size ? `?${query}` : ""}`;
}

/** @param {string} url @param {RequestInit} [options] */
async function request(url, options) {
  let response;
  try {
    response = await fetch(url, options);
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    throw new ApiError("The server does not respond. Is motionseek serve still running?", 0);
  }
  if (response.ok) return response;
  if (response.status === 401) throw new ApiError("Signed out: reload the page to sign in.", 401);
  const { error } = await response.json().catch(() => ({}));
  throw new ApiError(error ?? `The server responded with status ${response.status}.`, response.status);
}

/** @param {string} url @param {RequestInit} [options] */
const requestJson = async (url, options) => (await request(url, options)).json();

/**
 * @param {{like?: string, start?: string, end?: string}} like a clip that the hits shall be like, too, or a span of it
 * @param {AbortSignal} [signal] @returns {Promise<{query: string, language?: string, hits: Hit[]}>}
 */
export const search = (q, like, filters, k, offset, signal) => requestJson(address("search", { q, ...like, k, offset, ...filters }), { signal });

/** Moments of the whole library. @param {AbortSignal} [signal] @returns {Promise<{hits: Hit[], sentences?: string[], how?: "then" | "while", language?: string, without?: string[]}>} */
export const moments = (q, filters, k, offset, signal) => requestJson(address("moments", { q, k, offset, ...filters }), { signal });

/**
 * Moments of one clip, and its similarity to the sentence over time; with `split` of the steps of the sentence.
 * @returns {Promise<{hits: Hit[], sentences?: string[], curve: {times: number[], similarity: Record<string, number[]>}}>}
 */
export const momentsIn = (clip, q, k, split = false) => requestJson(address("moments", { clip, q, k, split }));

/** @returns {Promise<{sentences: {text: string, score: number}[]}>} */
export const describe = (clip, start, end, k = 5) => requestJson(address("describe", { clip, start, end, k }));

/** @param {AbortSignal} [signal] @returns {Promise<{query: string, hits: Hit[]}>} */
export const similar = (clip, start, end, filters, k, offset, signal) =>
  requestJson(address("similar", { clip, start, end, k, offset, ...filters }), { signal });

/** All clips, a varied choice of the seed first. @param {AbortSignal} [signal] @returns {Promise<{total: number, motions: MotionInfo[]}>} */
export const motions = (filters, limit, offset, order, signal) => requestJson(address("motions", { limit, offset, ...order, ...filters }), { signal });

/** Clips by their numbers or keys, those that are there. @param {string[]} clips @param {AbortSignal} [signal] @returns {Promise<MotionInfo[]>} */
export const motionsOf = async (clips, signal) =>
  clips.length ? (await requestJson(address("motions", { clip: clips, limit: 200 }), { signal })).motions : [];

/** The numbers of all clips that pass the filters. @returns {Promise<number[]>} */
export const clips = async (filters) => (await requestJson(address("clips", filters))).clips;

/** @returns {Promise<MotionInfo>} */
export const motion = (clip) => requestJson(address(`motions/${clip}`));

/** The map, or how far its layout is. @returns {Promise<MapData | {progress: number, count: number}>} */
export const map = () => requestJson(address("map"));

/** @returns {Promise<Record<string, any>>} */
export const stats = () => requestJson(address("stats"));

/** How many clips each value of a filter would leave. @returns {Promise<Record<string, {value?: string, from?: number, to?: number, count: number}[]>>} */
export const facets = (filters) => requestJson(address("facets", filters));

/** Clips that show one performance, or how far the search for them is. @returns {Promise<{stacks?: [number, boolean][][], progress?: number}>} */
export const stacks = () => requestJson(address("stacks"));

/** Stars, tags and collections, and whether the server may change them. @returns {Promise<{starred: number, tags: Record<string, number>, collections: Record<string, number>, edit: boolean}>} */
export const marks = () => requestJson(address("marks"));

/** Star, tag and collect clips. @param {{clips: (number | string)[], star?: boolean, tags?: string[], collections?: string[]}} change */
export const changeMarks = (change) => requestJson("api/marks", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(change) });

/** The URL of an archive of clips, or spans of them. @param {string[]} clips as 12 or 12:1.5:3.25 */
export const archiveAddress = (clips, format) => address("archive", { clip: clips, format });

/** What files can be read, and what they need beside them. @returns {Promise<import("./drop.js").Format[]>} */
export const formats = async () => (await requestJson(address("formats"))).formats;

/**
 * Upload a motion with the files it needs; `clip` of each motion in the response names it from then on.
 * @param {string} name @param {File[]} files the motion first @returns {Promise<MotionInfo[]>}
 */
export const upload = async (name, [motion, ...others]) => {
  const files = [motion, ...others];
  const parameters = { name: [name, ...others.map((file) => file.name)], size: files.map((file) => file.size) };
  return (await requestJson(address("uploads", parameters), { method: "POST", body: new Blob(files) })).motions;
};

/**
 * The motion of sentences, what each is shown by, and by what else it could be.
 * @param {import("./line.js").Sentence[]} sentences @param {AbortSignal} [signal] @returns {Promise<Composition>}
 */
export const compose = async (sentences, filters, signal) => {
  const { joints, ...made } = await requestJson(address("compose", filters), { ...posted(sentences), signal });
  return { ...made, motion: new Motion(Uint8Array.from(atob(joints), (one) => one.charCodeAt(0)).buffer) };
};

/** The same as a file with its report, in a ZIP archive. @param {import("./line.js").Sentence[]} sentences @returns {Promise<Blob>} */
export const composeFile = async (sentences, filters, to) => (await request(address("compose/file", { to, ...filters }), posted(sentences))).blob();

const posted = (/** @type {import("./line.js").Sentence[]} */ sentences) => ({
  method: "POST", headers: { "Content-Type": "application/json" },
  body: JSON.stringify({ sentences: sentences.map(({ text, start, end, parts, clip, at }) => ({ text, start, end, parts, clip, at: at ?? 0 })) }),
}); // prettier-ignore

/** The URL of a cut as a file. */
export const exportAddress = (clip, start, end, format) => address("export", { clip, start, end, format });

const CACHED = 96;
/** @type {Map<string, Promise<Motion>>} an LRU cache of motions by URL, oldest first */
const cache = new Map();

/**
 * The joints of a span, cached.
 * @param {number | string} clip @param {number} [start] @param {number} [end] @param {number} [fps]
 * @returns {Promise<Motion>}
 */
export function joints(clip, start, end, fps = 20) {
  const url = address(`motions/${clip}/joints`, { start, end, fps });
  const found = cache.get(url) ?? request(url).then(async (response) => new Motion(await response.arrayBuffer()));
  cache.delete(url);
  cache.set(url, found);
  found.catch(() => cache.delete(url));
  if (cache.size > CACHED) cache.delete(/** @type {string} */ (cache.keys().next().value));
  return found;
}
