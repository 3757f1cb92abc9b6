/**
 * A figure of tapered capsules with ground and soft shadow: one draw call each.
 */

import {
  CapsuleGeometry,
  CustomBlending,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  DoubleSide,
  MaxEquation,
  Mesh,
  PlaneGeometry,
  Scene,
  ShaderMaterial,
  Vector2,
  Vector3,
} from "./vendor/three/three.module.min.js";
import * as shaders from "./shaders.js";

/**
 * From joint, to joint, radius at either end, part. A negative "to" extends beyond the joint, away from joint -to,
 * by the last number in metres: heads, hands and toes have no joint at their tip.
 * @type {[number, number, number, number, "body" | "left" | "right", number?][]}
 */
export const BONES = [
  [0, 3, 0.112, 0.108, "body"], [3, 6, 0.108, 0.118, "body"], [6, 9, 0.118, 0.122, "body"], [9, 12, 0.085, 0.052, "body"],
  [12, 15, 0.05, 0.052, "body"], [15, -12, 0.088, 0.096, "body", 0.1],
  [16, 17, 0.062, 0.062, "body"], [1, 2, 0.1, 0.1, "body"],
  [6, 16, 0.1, 0.06, "body"], [6, 17, 0.1, 0.06, "body"], [3, 1, 0.1, 0.098, "body"], [3, 2, 0.1, 0.098, "body"],
  [1, 4, 0.086, 0.058, "left"], [4, 7, 0.057, 0.04, "left"], [7, 10, 0.04, 0.034, "left"], [10, -7, 0.034, 0.027, "left", 0.05],
  [2, 5, 0.086, 0.058, "right"], [5, 8, 0.057, 0.04, "right"], [8, 11, 0.04, 0.034, "right"], [11, -8, 0.034, 0.027, "right", 0.05],
  [16, 18, 0.052, 0.041, "left"], [18, 20, 0.041, 0.031, "left"], [20, -18, 0.034, 0.024, "left", 0.09],
  [17, 19, 0.052, 0.041, "right"], [19, 21, 0.041, 0.031, "right"], [21, -19, 0.034, 0.024, "right", 0.09],
]; // prettier-ignore

/** Joints that leave a trail, and the part whose colour it has. */
const TRAILS = /** @type {[number, "body" | "left" | "right"][]} */ ([[20, "left"], [21, "right"], [10, "left"], [11, "right"], [0, "body"]]);
const TRAIL_SECONDS = 1.6;
const TRAIL_PIECES = 32;

export const CAPSULE = new CapsuleGeometry(1, 1, 5, 14);
const SQUARE = new PlaneGeometry(2, 2);

/** @param {any} base @param {any} a @param {any} b @param {any} [tint] */
export function instanced(base, a, b, tint) {
  const geometry = new InstancedBufferGeometry();
  geometry.index = base.index;
  geometry.setAttribute("position", base.attributes.position);
  geometry.setAttribute("a", a);
  geometry.setAttribute("b", b);
  if (tint) geometry.setAttribute("tint", tint);
  geometry.instanceCount = a.count;
  return geometry;
}

/** Dispose of an instanced geometry without what all share: it would take all its attributes from the graphics card. */
export function disposeOf(geometry) {
  geometry.index = null;
  geometry.deleteAttribute("position");
  geometry.dispose();
}

/** @param {any} material */
export function mesh(geometry, material, order) {
  const made = new Mesh(geometry, material);
  made.frustumCulled = false;
  made.renderOrder = order;
  return made;
}

// All are transparent, so that render order decides: shadow, ground, body, trail.
const bodyMaterial = new ShaderMaterial({
  vertexShader: shaders.capsuleVertex, fragmentShader: shaders.capsuleFragment, transparent: true, premultipliedAlpha: true,
}); // prettier-ignore
export const trailMaterial = new ShaderMaterial({
  vertexShader: shaders.capsuleVertex, fragmentShader: shaders.capsuleFragment,
  transparent: true, premultipliedAlpha: true, depthWrite: false,
}); // prettier-ignore
const shadowMaterial = new ShaderMaterial({
  vertexShader: shaders.shadowVertex, fragmentShader: shaders.shadowFragment, uniforms: { strength: { value: 0.3 } }, side: DoubleSide,
  transparent: true, depthWrite: false, depthTest: false, blending: CustomBlending, blendEquation: MaxEquation,
}); // prettier-ignore
const groundMaterial = new ShaderMaterial({
  vertexShader: shaders.groundVertex, fragmentShader: shaders.groundFragment,
  uniforms: { centre: { value: new Vector2() }, line: { value: new Vector3() } },
  transparent: true, premultipliedAlpha: true, depthWrite: false, depthTest: false, side: DoubleSide,
}); // prettier-ignore

/** @typedef {{body: number[], left: number[], right: number[], ground: number[], shadow: number}} Palette colours 0 to 1 */

export class Figure {
  constructor() {
    const ends = (/** @type {number} */ count) => new InstancedBufferAttribute(new Float32Array(4 * count), 4);
    const pieces = TRAILS.length * TRAIL_PIECES;
    [this.a, this.b, this.tint] = [ends(BONES.length), ends(BONES.length), ends(BONES.length)];
    [this.trailA, this.trailB, this.trailTint] = [ends(pieces), ends(pieces), ends(pieces)];
    this.pose = new Float32Array(66);
    this.scene = new Scene();
    this.trail = mesh(instanced(CAPSULE, this.trailA, this.trailB, this.trailTint), trailMaterial, 4);
    this.trail.visible = false;
    this.meshes = [
      mesh(SQUARE, groundMaterial, 2),
      mesh(instanced(SQUARE, this.a, this.b), shadowMaterial, 1),
      mesh(instanced(CAPSULE, this.a, this.b, this.tint), bodyMaterial, 3),
      this.trail,
    ];
    this.scene.add(...this.meshes);
  }

  /** @param {Palette} palette */
  paint(palette) {
    BONES.forEach(([, , , , part], i) => this.tint.array.set([...palette[part], 1], 4 * i));
    TRAILS.forEach(([, part], t) => {
      for (let i = 0; i < TRAIL_PIECES; i++) this.trailTint.array.set([...palette[part], (0.75 * (i + 1)) / TRAIL_PIECES], 4 * (t * TRAIL_PIECES + i));
    });
    this.tint.needsUpdate = this.trailTint.needsUpdate = true;
    groundMaterial.uniforms.line.value.set(...palette.ground);
    shadowMaterial.uniforms.strength.value = palette.shadow;
  }

  /** Set the pose of a motion at a time in seconds. @param {import("./motion.js").Motion} motion @param {number} time */
  take(motion, time) {
    motion.sample(time, this.pose);
    // Written in place: this runs for every bone of every figure in every frame.
    const [a, b] = [this.a.array, this.b.array];
    for (let i = 0; i < BONES.length; i++) {
      const [from, to, near, far, , beyond = 0] = BONES[i];
      const tip = to < 0 ? from : to;
      const reach = to < 0 ? beyond / this.#length(from, -to) : 0;
      for (let axis = 0; axis < 3; axis++) {
        a[4 * i + axis] = this.pose[3 * from + axis];
        b[4 * i + axis] = this.pose[3 * tip + axis] + (to < 0 ? reach * (this.pose[3 * from + axis] - this.pose[3 * -to + axis]) : 0);
      }
      a[4 * i + 3] = near;
      b[4 * i + 3] = far;
    }
    this.a.needsUpdate = this.b.needsUpdate = true;
    if (this.trail.visible) this.#takeTrail(motion, time);
  }

  /** Centre the ground under the camera's target; it is shared by all figures, so this is done before each draw. */
  ground(x, z) {
    groundMaterial.uniforms.centre.value.set(x, z);
  }

  dispose() {
    for (const { geometry } of this.meshes.slice(1)) disposeOf(geometry);
  }

  /** The distance of two joints in metres, never 0. @param {number} from @param {number} to */
  #length(from, to) {
    const { pose } = this;
    return Math.hypot(pose[3 * from] - pose[3 * to], pose[3 * from + 1] - pose[3 * to + 1], pose[3 * from + 2] - pose[3 * to + 2]) || 1;
  }

  /** @param {import("./motion.js").Motion} motion @param {number} time */
  #takeTrail(motion, time) {
    const [now, before] = [new Float32Array(66), new Float32Array(66)];
    for (let i = TRAIL_PIECES; i >= 0; i--) {
      motion.sample(Math.max(time - TRAIL_SECONDS * (1 - i / TRAIL_PIECES), motion.start), now);
      if (i < TRAIL_PIECES)
        TRAILS.forEach(([joint], t) => {
          const at = 4 * (t * TRAIL_PIECES + i);
          this.trailA.array.set([...now.subarray(3 * joint, 3 * joint + 3), 0.012], at);
          this.trailB.array.set([...before.subarray(3 * joint, 3 * joint + 3), 0.012], at);
        });
      before.set(now);
    }
    this.trailA.needsUpdate = this.trailB.needsUpdate = true;
  }
}
