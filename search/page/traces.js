/**
 * What a motion leaves on the ground: the path of the root, with a mark each second, and the prints of the feet.
 */

import { InstancedBufferAttribute } from "./vendor/three/three.module.min.js";
import { CAPSULE, instanced, mesh, disposeOf, trailMaterial } from "./figure.js";

const PIECE = 0.1; // seconds of a piece of the path
const MOST = 4000; // pieces, of a take that is long

/** @typedef {{from: [number, number], to: [number, number], radius: number, colour: number[]}} Piece on the ground, in metres */

export class Traces {
  /** @param {any} scene of a figure */
  constructor(scene) {
    Object.assign(this, { scene, path: null, prints: null });
  }

  /**
   * @param {import("./motion.js").Motion} motion @param {import("./contacts.js").Contact[]} contacts
   * @param {import("./figure.js").Palette} palette @param {{path: boolean, prints: boolean}} shown
   */
  show(motion, contacts, palette, shown) {
    this.clear();
    this.path = this.#add(shown.path ? rootPath(motion, palette) : []);
    this.prints = this.#add(shown.prints ? footprints(contacts, palette) : []);
  }

  clear() {
    for (const made of [this.path, this.prints]) {
      if (!made) continue;
      this.scene.remove(made);
      disposeOf(made.geometry);
    }
    this.path = this.prints = null;
  }

  /** @param {Piece[]} pieces */
  #add(pieces) {
    if (!pieces.length) return null;
    const [a, b, tint] = [0, 1, 2].map(() => new InstancedBufferAttribute(new Float32Array(4 * pieces.length), 4));
    pieces.forEach(({ from, to, radius, colour }, i) => {
      a.array.set([from[0], 0, from[1], radius], 4 * i);
      b.array.set([to[0], 0, to[1], radius], 4 * i);
      tint.array.set([...colour, 1], 4 * i);
    });
    const made = mesh(instanced(CAPSULE, a, b, tint), trailMaterial, 2.5);
    this.scene.add(made);
    return made;
  }
}

/** @param {import("./motion.js").Motion} motion @param {import("./figure.js").Palette} palette @returns {Piece[]} */
function rootPath(motion, palette) {
  const step = Math.max(PIECE, (motion.end - motion.start) / MOST);
  const pose = new Float32Array(66);
  const places = Array.from({ length: Math.floor((motion.end - motion.start) / step) + 1 }, (_, i) => {
    motion.sample(motion.start + i * step, pose);
    return /** @type {[number, number]} */ ([pose[0], pose[2]]);
  });
  const line = places.slice(1).map((to, i) => ({ from: places[i], to, radius: 0.01, colour: palette.body }));
  const every = Math.max(Math.round(1 / step), 1);
  const seconds = places.filter((_, i) => i % every === 0).map((at) => ({ from: at, to: /** @type {[number, number]} */ ([at[0], at[1] + 1e-4]), radius: 0.028, colour: palette.body }));
  return [...line, ...seconds];
}

/** @param {import("./contacts.js").Contact[]} contacts @param {import("./figure.js").Palette} palette @returns {Piece[]} */
const footprints = (contacts, palette) => contacts.map(({ side, ankle, toes }) => ({ from: ankle, to: toes, radius: 0.032, colour: palette[side] }));
