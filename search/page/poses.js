/**
 * The strip of poses of a take: small figures along the time line, drawn flat for the part of it that is in view.
 */

import { BONES } from "./figure.js";

const APART = 58; // pixels between two poses
const HEAD_ROOM = 4; // pixels

export class Poses {
  /** @param {HTMLCanvasElement} canvas as wide as what is in view of the time line */
  constructor(canvas) {
    this.canvas = canvas;
    this.pose = new Float32Array(66);
    /** @type {import("./motion.js").Motion | null} */
    this.motion = null;
  }

  /**
   * @param {(time: number) => number} place of a time, in pixels of the canvas
   * @param {(x: number) => number} time at a place
   */
  draw(place, time) {
    const { canvas, motion } = this;
    const { clientWidth: width, clientHeight: height } = canvas;
    if (!width) return;
    const ratio = Math.min(devicePixelRatio, 2);
    [canvas.width, canvas.height] = [width * ratio, height * ratio];
    const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    pen.scale(ratio, ratio);
    if (!motion) return;
    const style = getComputedStyle(document.documentElement);
    const colours = Object.fromEntries(["body", "left", "right"].map((part) => [part, style.getPropertyValue(`--figure-${part}`)]));
    const scale = (height - HEAD_ROOM) / Math.max(motion.reach.up + 0.1, 1.85);
    // The same times are drawn wherever the strip is scrolled to: poses stand on a grid of the whole take.
    const step = Math.max(time(APART) - time(0), 1e-3);
    const first = Math.max(Math.ceil((time(0) - motion.start) / step - 0.5), 0);
    const last = Math.floor((Math.min(time(width), motion.end) - motion.start) / step - 0.5);
    for (let i = first; i <= last; i++) {
      const at = motion.start + (i + 0.5) * step;
      motion.sample(at, this.pose);
      this.#figure(pen, place(at), height - 2, scale, motion.heading + 0.6, colours);
    }
  }

  /** @param {CanvasRenderingContext2D} pen @param {number} x @param {number} y of the ground @param {number} scale pixels a metre @param {number} yaw @param {Record<string, string>} colours */
  #figure(pen, x, y, scale, yaw, colours) {
    const { pose } = this;
    const [cos, sin] = [Math.cos(yaw), Math.sin(yaw)];
    const flat = (/** @type {number} */ joint) => {
      const [dx, dz] = [pose[3 * joint] - pose[0], pose[3 * joint + 2] - pose[2]];
      return [x + scale * (dx * cos - dz * sin), y - scale * pose[3 * joint + 1], dx * sin + dz * cos];
    };
    pen.lineCap = "round";
    const ends = BONES.map(([from, to, near, far, part, beyond = 0]) => {
      const [a, b] = [flat(from), flat(Math.abs(to))];
      const past = to < 0 ? beyond / (Math.hypot(pose[3 * from] - pose[-3 * to], pose[3 * from + 1] - pose[1 - 3 * to], pose[3 * from + 2] - pose[2 - 3 * to]) || 1) : 0;
      const tip = to < 0 ? a.map((value, axis) => value + past * (value - b[axis])) : b;
      return { a, tip, thick: near + far, part };
    });
    for (const { a, tip, thick, part } of ends.sort((one, other) => one.a[2] + one.tip[2] - other.a[2] - other.tip[2])) {
      pen.strokeStyle = colours[part];
      pen.lineWidth = Math.max(thick * scale, 1);
      pen.beginPath();
      pen.moveTo(a[0], a[1]);
      pen.lineTo(tip[0], tip[1]);
      pen.stroke();
    }
  }
}
