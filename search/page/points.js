/**
 * The points of the map on two canvases: the points, drawn when they change, and rings and lasso above, drawn at every move.
 *
 * There may be a hundred thousand: what is near the pointer is found in a grid of cells, not by looking at all.
 */

import { clamp } from "./dom.js";

const COLOURS = 8; // labels with their own colour; the others share one
const MARGIN = 26;
const CELL = 16; // pixels
const ROUND = 2; // radius from which points are drawn as discs

/** @typedef {[number, number]} Place in pixels */

export class Points {
  /** @param {HTMLCanvasElement} sheet @param {HTMLCanvasElement} overlay both of one size */
  constructor(sheet, overlay) {
    Object.assign(this, { sheet, overlay });
    this.set([], [], []);
  }

  /** @param {ArrayLike<number>} x 0 to 1 @param {ArrayLike<number>} y @param {ArrayLike<number>} label */
  set(x, y, label) {
    this.x = Float32Array.from(x);
    this.y = Float32Array.from(y);
    this.label = label;
    /** Whether each point passes the filters: only those are found. */
    this.passing = new Uint8Array(x.length).fill(1);
    this.places = new Float32Array(2 * x.length);
    this.width = this.height = 0;
  }

  get length() {
    return this.x.length;
  }

  /** The radius of a point, in pixels. */
  get size() {
    return clamp(90 / Math.sqrt(this.length), 0.8, 6);
  }

  /** @param {number} i @returns {Place} */
  place(i) {
    return [this.places[2 * i], this.places[2 * i + 1]];
  }

  /** Fit to the size of the canvas. */
  #layOut() {
    const { clientWidth: width, clientHeight: height } = this.overlay;
    const ratio = Math.min(devicePixelRatio, 2);
    if (width === this.width && height === this.height && ratio === this.ratio) return;
    Object.assign(this, { width, height, ratio, columns: Math.ceil(width / CELL) + 1 });
    for (const canvas of [this.sheet, this.overlay]) [canvas.width, canvas.height] = [width * ratio, height * ratio];
    // Points sorted by their cell: `first[cell]` to `first[cell + 1]` in `inCells`.
    const first = new Uint32Array(this.columns * (Math.ceil(height / CELL) + 1) + 1);
    for (let i = 0; i < this.length; i++) {
      this.places[2 * i] = MARGIN + this.x[i] * (width - 2 * MARGIN);
      this.places[2 * i + 1] = MARGIN + (1 - this.y[i]) * (height - 2 * MARGIN);
      first[this.#cell(i) + 1]++;
    }
    for (let cell = 1; cell < first.length; cell++) first[cell] += first[cell - 1];
    const next = first.slice();
    this.inCells = new Uint32Array(this.length);
    for (let i = 0; i < this.length; i++) this.inCells[next[this.#cell(i)]++] = i;
    this.first = first;
  }

  /** @param {number} i */
  #cell(i) {
    return Math.floor(this.places[2 * i + 1] / CELL) * this.columns + Math.floor(this.places[2 * i] / CELL);
  }

  /** The nearest point that passes, within a distance in pixels; -1 where there is none. @param {Place} at @param {number} within */
  nearest([x, y], within) {
    let [best, least] = [-1, within];
    if (!this.first) return best;
    const rows = (this.first.length - 1) / this.columns;
    const reach = Math.ceil(within / CELL);
    const [column, row] = [Math.floor(x / CELL), Math.floor(y / CELL)];
    for (let r = Math.max(row - reach, 0); r <= Math.min(row + reach, rows - 1); r++)
      for (let c = Math.max(column - reach, 0); c <= Math.min(column + reach, this.columns - 1); c++)
        for (let k = this.first[r * this.columns + c]; k < this.first[r * this.columns + c + 1]; k++) {
          const i = this.inCells[k];
          const away = this.passing[i] ? Math.hypot(this.places[2 * i] - x, this.places[2 * i + 1] - y) : Infinity;
          if (away < least) [best, least] = [i, away];
        }
    return best;
  }

  /** The next point from one in a direction; itself where there is none. @param {number} from @param {Place} way */
  next(from, way) {
    const [x, y] = this.place(from);
    let [best, least] = [from, Infinity];
    for (let i = 0; i < this.length; i++) {
      const [dx, dy] = [this.places[2 * i] - x, this.places[2 * i + 1] - y];
      const along = dx * way[0] + dy * way[1];
      const away = along + 2 * (Math.abs(dx * way[1]) + Math.abs(dy * way[0]));
      if (along > 0.5 && away < least && this.passing[i]) [best, least] = [i, away];
    }
    return best;
  }

  /** The points that pass and meet a condition. @param {(i: number) => boolean} condition @returns {Set<number>} */
  where(condition) {
    const found = new Set();
    for (let i = 0; i < this.length; i++) if (this.passing[i] && condition(i)) found.add(i);
    return found;
  }

  /** The points inside a polygon. @param {Place[]} corners */
  inside(corners) {
    const [left, right] = [Math.min(...corners.map(([x]) => x)), Math.max(...corners.map(([x]) => x))];
    const [top, bottom] = [Math.min(...corners.map(([, y]) => y)), Math.max(...corners.map(([, y]) => y))];
    return this.where((i) => {
      const [x, y] = this.place(i);
      return x >= left && x <= right && y >= top && y <= bottom && contains(corners, x, y);
    });
  }

  /** Draw the points. @param {(i: number) => boolean} isLit others are dim */
  draw(isLit) {
    if (!this.overlay.clientWidth) return;
    this.#layOut();
    const pen = this.sheet.getContext("2d");
    const style = getComputedStyle(document.documentElement);
    const colours = Array.from({ length: COLOURS + 1 }, (_, kind) => style.getPropertyValue(kind < COLOURS ? `--kind-${kind}` : "--kind-other"));
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    /** @type {number[][]} points by how they look, so that the pen changes seldom; the dim ones below */
    const looks = Array.from({ length: 3 * (COLOURS + 1) }, () => []);
    for (let i = 0; i < this.length; i++) looks[(this.passing[i] ? 1 + Number(isLit(i)) : 0) * (COLOURS + 1) + Math.min(this.label[i], COLOURS)].push(i);
    const { size } = this;
    looks.forEach((points, look) => {
      pen.globalAlpha = [0.08, 0.22, 1][Math.floor(look / (COLOURS + 1))];
      pen.fillStyle = colours[look % (COLOURS + 1)];
      for (const i of points) {
        const [x, y] = [this.places[2 * i], this.places[2 * i + 1]];
        if (size < ROUND) pen.fillRect(x - size, y - size, 2 * size, 2 * size);
        else {
          pen.beginPath();
          pen.arc(x, y, size, 0, 7);
          pen.fill();
        }
      }
    });
  }

  /**
   * Draw the overlay.
   * @param {Iterable<[number, number]>} rings points and the widths of their rings @param {number} hovered @param {Place[]} lasso
   */
  mark(rings, hovered, lasso) {
    if (!this.width) return;
    const pen = this.overlay.getContext("2d");
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    pen.strokeStyle = getComputedStyle(document.documentElement).getPropertyValue("--accent");
    const ring = (/** @type {number} */ i, /** @type {number} */ away, /** @type {number} */ width) => {
      pen.lineWidth = width;
      pen.beginPath();
      pen.arc(...this.place(i), this.size + away, 0, 7);
      pen.stroke();
    };
    for (const [i, width] of rings) ring(i, 3.5, width);
    if (hovered >= 0) ring(hovered, 6, 2.5);
    if (lasso.length < 2) return;
    pen.lineWidth = 1.5;
    pen.setLineDash([5, 4]);
    pen.beginPath();
    lasso.forEach((corner) => pen.lineTo(...corner));
    pen.closePath();
    pen.stroke();
    pen.setLineDash([]);
  }
}

/** Whether a point lies inside a polygon, by ray casting. @param {Place[]} corners @param {number} x @param {number} y */
function contains(corners, x, y) {
  let odd = false;
  for (let i = 0, j = corners.length - 1; i < corners.length; j = i++) {
    const [[ax, ay], [bx, by]] = [corners[i], corners[j]];
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) odd = !odd;
  }
  return odd;
}
