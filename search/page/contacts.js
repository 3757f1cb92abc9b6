/**
 * When and where the feet of a motion stand on the ground.
 */

const SIDES = /** @type {const} */ ([["left", 7, 10], ["right", 8, 11]]); // ankle and toes
const FASTEST = 0.35; // metres a second that the toes of a standing foot move
const HIGHEST = 0.12; // metres that they are above the lowest point of the feet
const SHORTEST = 0.1; // seconds; shorter steps and gaps are noise

/** @typedef {{side: "left" | "right", start: number, end: number, ankle: [number, number], toes: [number, number]}} Contact x and z in metres */

/** @param {import("./motion.js").Motion} motion @returns {Contact[]} in order of time on each side */
export function contacts(motion) {
  const at = (/** @type {number} */ frame, /** @type {number} */ joint) => 66 * frame + 3 * joint;
  const { positions, frames, fps, start } = motion;
  let ground = Infinity;
  for (let frame = 0; frame < frames; frame++) for (const [, , toes] of SIDES) ground = Math.min(ground, positions[at(frame, toes) + 1]);
  return SIDES.flatMap(([side, ankle, toes]) => {
    const stands = Array.from({ length: frames }, (_, frame) => {
      const [a, b] = [at(Math.max(frame - 1, 0), toes), at(Math.min(frame + 1, frames - 1), toes)];
      const steps = Math.min(frame + 1, frames - 1) - Math.max(frame - 1, 0) || 1;
      const speed = (Math.hypot(positions[b] - positions[a], positions[b + 1] - positions[a + 1], positions[b + 2] - positions[a + 2]) * fps) / steps;
      return speed < FASTEST && positions[at(frame, toes) + 1] < ground + HIGHEST;
    });
    return runs(stands, SHORTEST * fps).map(([first, last]) => {
      const middle = Math.round((first + last) / 2);
      const ground = (/** @type {number} */ joint) => /** @type {[number, number]} */ ([positions[at(middle, joint)], positions[at(middle, joint) + 2]]);
      return { side, start: start + first / fps, end: start + last / fps, ankle: ground(ankle), toes: ground(toes) };
    });
  });
}

/** The runs of true, first and last index; short gaps are closed, then short runs left out. @param {boolean[]} flags @param {number} shortest */
export function runs(flags, shortest) {
  /** @type {[number, number][]} */
  const found = [];
  flags.forEach((flag, i) => {
    if (!flag) return;
    const before = found.at(-1);
    if (before && i - before[1] <= shortest) before[1] = i;
    else found.push([i, i]);
  });
  return found.filter(([first, last]) => last - first >= shortest);
}
