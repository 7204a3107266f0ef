/** A portrait in three dimensions that the reader turns. */

import { CanvasSurface, SvgSurface } from "../draw/surface.js";
import { drawSpace, Space, SpaceView } from "./space.js";

/** The direction of view to begin with, in degrees. */
const FIRST = { azimuth: -55, elevation: 22, zoom: 1 };
/** Degrees per pixel of dragging, and per key. */
const PER_PIXEL = 0.45;
const PER_KEY = 5;
/** The nearest and the farthest. */
const ZOOMS = [0.4, 20];
/** After so many milliseconds without a turn all points are drawn. */
const SETTLED = 140;
/** A way back to the first direction takes so many milliseconds. */
const RETURN = 260;

/**
 * Curves in three dimensions on a canvas: turned by dragging and by arrow keys, zoomed by pinching, by the
 * keys + and - and, once the canvas has the focus or with Ctrl, by the wheel; a double click or the key 0
 * goes back.
 */
export class Portrait3d {
  /**
   * @param {HTMLCanvasElement} canvas which its style sizes
   * @param {import("./space.js").SpaceContent} content
   * @param {object | (() => object)} view as of `draw`: width, height and theme
   */
  constructor(canvas, content, view) {
    this.canvas = canvas;
    this.readView = typeof view === "function" ? view : () => view;
    /** The direction of view; call `draw` after a change. */
    this.turned = { ...FIRST };
    this.pointers = new Map();
    this.space = new Space(content);
    /** Milliseconds that the last frame took. */
    this.took = 0;
    this.listeners = new AbortController();
    this.listen();
    this.draw();
  }

  /** Shows other curves from the same direction. */
  set(content, view) {
    this.space = new Space(content);
    if (view) this.readView = typeof view === "function" ? view : () => view;
    this.draw();
  }

  /** Draws all at the next frame, with the size and the colours of then. */
  draw() {
    this.view = null;
    this.ask(false);
  }

  /** Returns the portrait as a standalone SVG. */
  svg(view = this.readView()) {
    const surface = new SvgSurface(view);
    drawSpace(surface, this.space, view, this.turned);
    return surface.text();
  }

  /** Goes back to the first direction. */
  reset() {
    const still = globalThis.matchMedia?.("(prefers-reduced-motion: reduce)").matches;
    const from = { ...this.turned };
    // The shorter way around.
    from.azimuth = FIRST.azimuth + ((((from.azimuth - FIRST.azimuth + 180) % 360) + 360) % 360) - 180;
    const begin = performance.now();
    const step = () => {
      const part = still ? 1 : Math.min(1, (performance.now() - begin) / RETURN);
      const eased = part * part * (3 - 2 * part);
      for (const name of Object.keys(FIRST))
        this.turned[name] = from[name] + eased * (FIRST[name] - from[name]);
      this.ask(part < 1);
      this.returning = part < 1 ? requestAnimationFrame(step) : 0;
    };
    cancelAnimationFrame(this.returning);
    step();
  }

  /**
   * Returns the point of the curves that is seen nearest to a place; of several about equally near ones the
   * nearest to the eye.
   *
   * @param {number} px
   * @param {number} py
   * @param {number} [within] pixels
   * @returns {{curve: number, index: number, distance: number, px: number, py: number} | null}
   */
  nearest(px, py, within = Infinity) {
    const seen = new SpaceView(this.turned, this.view ?? this.readView());
    let best = null;
    let least = Infinity;
    this.space.curves.forEach(({ xyz }, curve) => {
      for (let i = 0; i < xyz.length; i += 3) {
        const [x, y, depth] = seen.place([xyz[i], xyz[i + 1], xyz[i + 2]]);
        const distance = Math.hypot(x - px, y - py);
        if (!(distance <= within) || distance - 2 * depth >= least) continue;
        least = distance - 2 * depth;
        best = { curve, index: i / 3, distance, px: x, py: y };
      }
    });
    return best;
  }

  /** Ends all that listens and waits. */
  close() {
    this.listeners.abort();
    cancelAnimationFrame(this.frame);
    cancelAnimationFrame(this.returning);
    clearTimeout(this.settling);
  }

  /** Draws at the next frame: quickly while it turns, and then once with all points. */
  ask(quick) {
    this.quick = quick;
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      this.drawNow();
    });
  }

  drawNow() {
    if (!this.canvas.isConnected) return;
    const begin = performance.now();
    this.view ??= this.readView();
    const surface = new CanvasSurface(this.canvas, this.view);
    drawSpace(surface, this.space, this.view, this.turned, this.quick);
    this.took = performance.now() - begin;
    clearTimeout(this.settling);
    if (this.quick) this.settling = setTimeout(() => this.ask(false), SETTLED);
  }

  turn(across, down) {
    this.turned.azimuth -= across;
    this.turned.elevation = Math.min(90, Math.max(-90, this.turned.elevation + down));
    this.ask(true);
  }

  zoom(factor) {
    const [least, most] = ZOOMS;
    this.turned.zoom = Math.min(most, Math.max(least, this.turned.zoom * factor));
    this.ask(true);
  }

  listen() {
    const { canvas } = this;
    const on = (name, act, more = {}) => {
      canvas.addEventListener(name, act, { signal: this.listeners.signal, ...more });
    };
    canvas.style.touchAction = "none";
    if (!canvas.hasAttribute("tabindex")) canvas.tabIndex = 0;
    on("pointerdown", (event) => {
      if (event.button !== 0) return;
      cancelAnimationFrame(this.returning);
      this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
      canvas.setPointerCapture(event.pointerId);
      canvas.focus({ preventScroll: true });
    });
    on("pointermove", (event) => this.move(event));
    const lift = (event) => this.pointers.delete(event.pointerId);
    on("pointerup", lift);
    on("pointercancel", lift);
    on("lostpointercapture", lift);
    on(
      "wheel",
      (event) => {
        // The page scrolls on while the pointer just passes over the portrait.
        if (document.activeElement !== canvas && !event.ctrlKey && !event.shiftKey) return;
        event.preventDefault();
        const lines = event.deltaMode === 1 ? 16 : 1;
        this.zoom(Math.exp(-(event.deltaY || event.deltaX) * lines * (event.ctrlKey ? 0.01 : 0.0015)));
      },
      { passive: false },
    );
    on("dblclick", () => this.reset());
    on("keydown", (event) => this.key(event));
  }

  /** One finger turns; two zoom by their distance, and turn by their middle. */
  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const [x, y] = [now[0] - before[0], now[1] - before[1]];
    const others = [...this.pointers].filter(([id]) => id !== event.pointerId);
    this.pointers.set(event.pointerId, now);
    const share = 1 / this.pointers.size;
    if (others.length) {
      const [ox, oy] = others[0][1];
      const apart = (place) => Math.max(1, Math.hypot(place[0] - ox, place[1] - oy));
      this.zoom(apart(now) / apart(before));
    }
    this.turn(PER_PIXEL * x * share, PER_PIXEL * y * share);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = event.shiftKey ? 3 * PER_KEY : PER_KEY;
    const acts = {
      ArrowLeft: () => this.turn(-step, 0),
      ArrowRight: () => this.turn(step, 0),
      ArrowUp: () => this.turn(0, -step),
      ArrowDown: () => this.turn(0, step),
      "+": () => this.zoom(1.2),
      "=": () => this.zoom(1.2),
      "-": () => this.zoom(1 / 1.2),
      0: () => this.reset(),
    };
    if (!acts[event.key]) return;
    event.preventDefault();
    event.stopPropagation();
    acts[event.key]();
  }
}
