/**
 * Times of a file as frames and as timecode.
 */

const STORED_FPS = 20; // of the library's poses, where the file's rate is not known

/** The frame rate that frames are counted at. @param {import("./api.js").MotionInfo} info */
export const rateOf = (info) => info.source_fps ?? STORED_FPS;

/** The frame of a time. @param {number} time @param {number} fps */
export const frameOf = (time, fps) => Math.round(time * fps);

/** A time as `hours:minutes:seconds:frames`, non-drop: at 29.97 frames a second are counted 30 to the second. @param {number} time @param {number} fps */
export function timecode(time, fps) {
  const nominal = Math.max(Math.round(fps), 1);
  const frame = frameOf(time, fps);
  const seconds = Math.floor(frame / nominal);
  const parts = [Math.floor(seconds / 3600), Math.floor(seconds / 60) % 60, seconds % 60];
  const width = String(nominal - 1).length;
  return [...parts.map((part) => String(part).padStart(2, "0")), String(frame % nominal).padStart(Math.max(width, 2), "0")].join(":");
}
