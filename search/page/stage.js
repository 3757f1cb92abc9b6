/**
 * One WebGL canvas for all figures: each view draws into the rectangle of its element.
 */

import { PerspectiveCamera, WebGLRenderer } from "./vendor/three/three.module.min.js";
import { clamp } from "./dom.js";
import { Figure } from "./figure.js";

const FIELD_OF_VIEW = 26;
const PITCH = 0.2;
const DISTANCE = 4.8; // metres, from which a standing figure fits
const SLOWEST_FRAME = 0.1;

/** A figure shown in an element, its camera and its time. */
export class View {
  /** @param {Stage} stage @param {HTMLElement} element */
  constructor(stage, element) {
    Object.assign(this, { stage, element });
    this.figure = new Figure();
    /** @type {import("./motion.js").Motion | null} */
    this.motion = null;
    this.time = this.from = this.to = 0;
    [this.yaw, this.pitch, this.zoom, this.eye] = [0.6, PITCH, 1, 0.86];
    [this.playing, this.loop, this.speed, this.visible] = [false, true, 1, false];
    /** @type {(() => void) | null} called when the time has changed */
    this.onTime = null;
    /** @type {View | null} another view that is turned with this one */
    this.twin = null;
    this.#orbit();
  }

  /** @param {import("./motion.js").Motion} motion */
  show(motion) {
    this.motion = motion;
    [this.from, this.to] = [motion.start, motion.end];
    this.yaw = motion.heading + 0.6;
    this.zoom = clamp(Math.max(motion.reach.side / 0.9, motion.reach.up / 1.85), 1, 2.2);
    this.eye = clamp(motion.reach.up / 2 - 0.05, 0.86, 1.6);
    this.seek(motion.start);
  }

  /** @param {number} time */
  seek(time) {
    this.time = clamp(time, this.from, this.to);
    this.stage.dirty = true;
    this.onTime?.();
  }

  /** @param {number} seconds elapsed */
  advance(seconds) {
    if (!this.playing || !this.motion) return;
    const next = this.time + seconds * this.speed;
    if (next > this.to && !this.loop) this.playing = false;
    this.seek(next > this.to && this.loop ? this.from : next);
  }

  remove() {
    this.stage.views.delete(this);
    this.figure.dispose();
    this.stage.dirty = true;
  }

  /** Turn the twin, each seen from the same side of its own heading. */
  #turned() {
    const { twin } = this;
    if (twin?.motion && this.motion) Object.assign(twin, { yaw: this.yaw - this.motion.heading + twin.motion.heading, pitch: this.pitch, zoom: this.zoom });
    this.stage.dirty = true;
  }

  /** Drag to turn, Ctrl and wheel (or pinch) to zoom; a drag is not a click. */
  #orbit() {
    let dragged = false;
    this.element.addEventListener("pointerdown", (down) => {
      if (down.button !== 0) return;
      dragged = false;
      const [x, y, yaw, pitch] = [down.clientX, down.clientY, this.yaw, this.pitch];
      const move = (/** @type {PointerEvent} */ event) => {
        dragged ||= Math.hypot(event.clientX - x, event.clientY - y) > 4;
        this.yaw = yaw - (event.clientX - x) * 0.01;
        this.pitch = clamp(pitch + (event.clientY - y) * 0.008, -0.05, 1.5);
        this.#turned();
      };
      const stop = new AbortController();
      for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => stop.abort(), { signal: stop.signal });
      addEventListener("pointermove", move, { signal: stop.signal });
    });
    this.element.addEventListener("click", (event) => dragged && event.preventDefault());
    this.element.addEventListener("dragstart", (event) => event.preventDefault());
    this.element.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.zoom = clamp(this.zoom * Math.exp(event.deltaY * 0.005), 0.4, 4);
      this.#turned();
    }, { passive: false }); // prettier-ignore
  }
}

export class Stage {
  /** @param {HTMLCanvasElement} canvas @throws {Error} where the browser has no WebGL */
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: true, powerPreference: "high-performance" });
    this.renderer.autoClear = false;
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.info.autoReset = false;
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.1, 100);
    /** @type {Set<View>} */
    this.views = new Set();
    this.dirty = true;
    this.repaint();
    this.before = performance.now();
    for (const event of ["scroll", "resize"]) addEventListener(event, () => (this.dirty = true), { passive: true });
    new ResizeObserver(() => this.#draw()).observe(document.body); // before the new layout is painted
    requestAnimationFrame((now) => this.#tick(now));
  }

  /** @param {HTMLElement} element */
  add(element) {
    const view = new View(this, element);
    view.figure.paint(this.palette);
    this.views.add(view);
    return view;
  }

  /** Read the colours from the style sheet. */
  repaint() {
    const style = getComputedStyle(document.documentElement);
    const colour = (/** @type {string} */ name) => style.getPropertyValue(`--figure-${name}`).trim().match(/[0-9a-f]{2}/gi)?.map((part) => parseInt(part, 16) / 255) ?? [0.5, 0.5, 0.5];
    this.palette = { body: colour("body"), left: colour("left"), right: colour("right"), ground: colour("ground"), shadow: Number(style.getPropertyValue("--figure-shadow")) };
    for (const view of this.views) view.figure.paint(this.palette);
    this.dirty = true;
  }

  #tick(now) {
    requestAnimationFrame((later) => this.#tick(later));
    const seconds = Math.min((now - this.before) / 1000, SLOWEST_FRAME);
    this.before = now;
    for (const view of this.views) if (view.visible) view.advance(seconds);
    if (this.dirty) this.#draw();
  }

  #draw() {
    this.dirty = false;
    const [width, height] = [document.documentElement.clientWidth, innerHeight];
    const ratio = Math.min(devicePixelRatio, 2);
    if (this.width !== width || this.height !== height || this.ratio !== ratio) {
      Object.assign(this, { width, height, ratio });
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height);
    }
    // The canvas scrolls with the page until it is moved back here, so that figures stay in their elements meanwhile.
    this.canvas.style.transform = `translate(${scrollX}px, ${scrollY}px)`;
    this.renderer.setScissorTest(false);
    this.renderer.clear();
    this.renderer.setScissorTest(true);
    for (const view of this.views) this.#drawView(view, width, height);
  }

  /** @param {View} view @param {number} width @param {number} height */
  #drawView(view, width, height) {
    const box = view.element.getBoundingClientRect();
    view.visible = box.width > 0 && box.bottom > 0 && box.top < height && box.right > 0 && box.left < width;
    if (!view.visible || !view.motion) return;
    const [x, z] = view.motion.centre(view.time);
    const aspect = box.width / box.height;
    const away = (DISTANCE * view.zoom) / Math.min(1, aspect * 1.15);
    const flat = away * Math.cos(view.pitch);
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
    this.camera.position.set(x + flat * Math.sin(view.yaw), view.eye + away * Math.sin(view.pitch), z + flat * Math.cos(view.yaw));
    this.camera.lookAt(x, view.eye, z);
    this.renderer.setViewport(box.left, height - box.bottom, box.width, box.height);
    this.renderer.setScissor(box.left, height - box.bottom, box.width, box.height);
    this.renderer.clearDepth();
    view.figure.take(view.motion, view.time);
    view.figure.ground(x, z);
    this.renderer.render(view.figure.scene, this.camera);
  }
}
