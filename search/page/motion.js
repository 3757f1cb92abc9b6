/**
 * The 22 joints of a span over time, as the server sends them (docs/serving.md, "MSJ1").
 */

import { clamp } from "./dom.js";

const JOINTS = 22;
const LEFT_HIP = 1;
const RIGHT_HIP = 2;
const FOLLOW_SECONDS = 1.2;

export class Motion {
  /** @param {ArrayBuffer} data */
  constructor(data) {
    const head = new DataView(data);
    if (head.getUint32(0, false) !== 0x4d534a31 || head.getUint32(8, true) !== JOINTS) throw new Error("The server sent joints in an unknown format.");
    this.frames = head.getUint32(4, true);
    this.fps = head.getFloat32(12, true);
    /** Time of the first frame in the clip, in seconds. */
    this.start = head.getFloat32(16, true);
    this.end = this.start + (this.frames - 1) / this.fps;
    const step = head.getFloat32(20, true);
    const origin = [24, 28, 32].map((at) => head.getFloat32(at, true));
    const steps = new Int16Array(data, 40, this.frames * JOINTS * 3);
    /** x, y, z of joint after joint, frame after frame, in metres. */
    this.positions = Float32Array.from(steps, (value, i) => origin[i % 3] + value * step);
    this.follow = this.#smoothRoot();
    this.heading = this.#heading();
    this.reach = this.#reach();
  }

  /**
   * The pose at a time in the clip, linearly interpolated.
   * @param {number} time @param {Float32Array} pose (66) filled
   */
  sample(time, pose) {
    const [from, to, part] = this.#between(time);
    const a = from * JOINTS * 3;
    const b = to * JOINTS * 3;
    for (let i = 0; i < JOINTS * 3; i++) pose[i] = this.positions[a + i] + part * (this.positions[b + i] - this.positions[a + i]);
  }

  /** The camera's target at a time: x and z of the smoothed root. @param {number} time @returns {[number, number]} */
  centre(time) {
    const [from, to, part] = this.#between(time);
    const at = (/** @type {number} */ axis) => this.follow[2 * from + axis] + part * (this.follow[2 * to + axis] - this.follow[2 * from + axis]);
    return [at(0), at(1)];
  }

  /** @param {number} time @returns {[number, number, number]} */
  #between(time) {
    const at = clamp((time - this.start) * this.fps, 0, this.frames - 1);
    const from = Math.floor(at);
    return [from, Math.min(from + 1, this.frames - 1), at - from];
  }

  /** x and z of the pelvis, a moving average over `FOLLOW_SECONDS`. */
  #smoothRoot() {
    const half = Math.round((FOLLOW_SECONDS * this.fps) / 2);
    const sums = new Float64Array(2 * (this.frames + 1));
    for (let i = 0; i < this.frames; i++)
      for (const axis of [0, 1]) sums[2 * (i + 1) + axis] = sums[2 * i + axis] + this.positions[i * JOINTS * 3 + 2 * axis];
    const smooth = new Float32Array(2 * this.frames);
    for (let i = 0; i < this.frames; i++) {
      const reach = Math.min(half, i, this.frames - 1 - i);
      const [low, high] = [i - reach, i + reach + 1];
      for (const axis of [0, 1]) smooth[2 * i + axis] = (sums[2 * high + axis] - sums[2 * low + axis]) / (high - low);
    }
    return smooth;
  }

  /** The mean facing direction of the hips, as an angle around Y from +Z. */
  #heading() {
    let x = 0;
    let z = 0;
    for (let i = 0; i < this.frames; i++) {
      const hips = i * JOINTS * 3;
      x -= this.positions[hips + 3 * LEFT_HIP + 2] - this.positions[hips + 3 * RIGHT_HIP + 2];
      z += this.positions[hips + 3 * LEFT_HIP] - this.positions[hips + 3 * RIGHT_HIP];
    }
    return Math.atan2(x, z);
  }

  /** The largest distance of any joint from the camera's target, and the largest height. */
  #reach() {
    let side = 0;
    let up = 0;
    for (let i = 0; i < this.positions.length; i += 3) {
      const frame = Math.floor(i / (JOINTS * 3));
      side = Math.max(side, Math.hypot(this.positions[i] - this.follow[2 * frame], this.positions[i + 2] - this.follow[2 * frame + 1]));
      up = Math.max(up, this.positions[i + 1]);
    }
    return { side, up };
  }
}
