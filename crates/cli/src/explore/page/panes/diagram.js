// The diagram of two parameters: curves of bifurcations as they are found, a map of regimes, and the points that are looked at.

import { button, element } from "../elements.js";
import { Pane, short, themeOf } from "./pane.js";
import { axisLabel, COLOURS, lineOf, markOf, panelOf } from "./panels.js";
import { parameterOf, rangeOf } from "../scene.js";
import { explained } from "../glossary.js";

/** What curves of each kind are called, with the label of their points, and their colours. */
const KINDS = {
  pitchfork: ["pitchfork (BP)", 0],
  "saddle-node": ["fold (LP)", 6],
  hopf: ["Hopf (HB)", 1],
  "orbit-pitchfork": ["pitchfork of orbits (PF)", 4],
  "orbit-saddle-node": ["fold of orbits (SN)", 2],
  "period-doubling": ["period doubling (PD)", 3],
  torus: ["torus (TR)", 5],
  homoclinic: ["homoclinic (HOM)", 7],
};
/** Labels of points that are no bifurcations. */
const PLAIN = ["EP", "UZ", "", null];
/** How far the arrow keys move a point, as a fraction of an axis. */
const KEY_STEP = 0.01;

/** The rows of one curve after another, as pairs of lists. */
function curvesOf(answer, x, y) {
  const place = (name) => answer.columns.indexOf(name);
  const [xs, ys, curve, symmetry] = [place(x), place(y), place("curve"), place("symmetry")];
  const all = new Map();
  for (const row of answer.rows) {
    const key = curve < 0 ? 0 : row[curve];
    if (!all.has(key)) all.set(key, { x: [], y: [], symmetry: symmetry < 0 ? null : row[symmetry] });
    all.get(key).x.push(row[xs]);
    all.get(key).y.push(row[ys]);
  }
  return [...all.values()];
}

export class DiagramPane extends Pane {
  constructor(app) {
    super(app, { title: "Diagram of two parameters", name: "diagram", height: 440 });
    this.zoomsByWheel = true;
    this.curves = new Map();
    this.map = null;
    this.drag = null;
    this.over = element("canvas", { class: "over", "aria-hidden": "true" });
    this.body.append(this.over);
    this.canvas.setAttribute("role", "application");
    this.canvas.setAttribute("aria-roledescription", "diagram");
    this.mapButton = button("Map of regimes", () => app.questions.askMap(), { title: "Compute the regime at each cell of a grid (sweep)" });
    this.orbitsButton = button("Curves of orbits", () => app.change({ orbits: true }), { title: "These take minutes here", hidden: true });
    this.heading.after(this.orbitsButton, this.mapButton);
    this.canvas.addEventListener("pointerdown", (event) => this.down(event));
    this.canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"]) this.canvas.addEventListener(name, (event) => this.up(event));
    this.canvas.addEventListener("keydown", (event) => this.key(event));
  }

  /** Curves of orbits are computed when they are asked for. */
  offerOrbits(wait) {
    this.orbitsButton.hidden = !wait;
  }

  /** Forgets the curves of another system or other parameters. */
  clear() {
    this.curves.clear();
    this.map = null;
    this.compose();
  }

  takeCurve(kind, answer) {
    if (answer.error?.kind === "numerical" && /no .* (is|are) found/.test(answer.error.message)) this.curves.delete(kind);
    else this.curves.set(kind, answer);
    this.answer = answer;
    this.compose();
  }

  forgetMap() {
    this.map = null;
    this.compose();
  }

  takeMap(answer) {
    this.take(answer);
    if (answer.pictures.length) this.map = answer.pictures.at(-1);
    this.compose();
  }

  compose() {
    const { scene, model } = this.app;
    const { x, y } = scene.axes;
    // The frame does not move beneath the pointer: a legend that grows waits for the end of the drag.
    if (!y || this.drag !== null) return;
    const axis = (name) => {
      const one = parameterOf(model, name);
      return { label: axisLabel(one), log: one.log && rangeOf(scene, model, name)[0] > 0, range: rangeOf(scene, model, name) };
    };
    const panel = panelOf(axis(x), axis(y));
    this.names = [];
    const mapped = this.map?.blocks[0]?.columns[0]?.find((one) => one.cells);
    if (mapped) panel.cells = mapped.cells;
    for (const [kind, answer] of this.curves) {
      const [label, colour] = KINDS[kind] ?? [kind, 6];
      let named = false;
      for (const curve of curvesOf(answer, x, y)) {
        const stroke = curve.symmetry === "asymmetric" ? "dashed" : "solid";
        panel.series.push(lineOf(named ? "" : label, curve.x, curve.y, COLOURS[colour], { stroke, width: 1.8 }));
        this.names.push(label);
        named = true;
      }
      for (const point of specialOf(answer)) {
        if (PLAIN.includes(point.label) || point.label === "TOP") continue;
        panel.marks.push(markOf(point[x], point[y], point.label, { colour: COLOURS[colour] }));
      }
    }
    const dashed = panel.series.some((one) => one.stroke === "dashed");
    if (dashed) panel.strokes.push({ stroke: "dashed", label: "asymmetric" });
    this.show(panel);
    const found = [...this.curves].filter(([, one]) => one.rows.length).map(([kind]) => KINDS[kind]?.[0] ?? kind);
    this.canvas.setAttribute("aria-label", this.spoken(found));
    this.drawPoints();
  }

  spoken(found) {
    const { scene, model } = this.app;
    const { x, y } = scene.axes;
    const names = [x, y].map((name) => parameterOf(model, name)?.symbol ?? name);
    const points = scene.points.map((point, i) => `point ${"AB"[i]} at ${names[0]} ${short(point[x])}, ${names[1]} ${short(point[y])}`);
    const curves = found.length ? `curves: ${found.join(", ")}` : "no curves yet";
    return `Diagram of ${names.join(" and ")}; ${curves}; ${points.join("; ")}. Arrow keys move the point, with shift further.`;
  }

  overlay() {
    this.drawPoints();
  }

  /** The points, above the curves, so that a drag draws nothing else. */
  drawPoints() {
    const box = this.canvas.getBoundingClientRect();
    const ratio = window.devicePixelRatio || 1;
    const over = this.over;
    over.style.width = `${box.width}px`;
    over.style.height = `${box.height}px`;
    over.width = Math.round(box.width * ratio);
    over.height = Math.round(box.height * ratio);
    if (!this.hits) return;
    const { scene } = this.app;
    const theme = themeOf(this.element);
    const context = over.getContext("2d", { willReadFrequently: true });
    context.scale(ratio, ratio);
    const frame = this.hits.frames[0];
    scene.points.forEach((point, i) => {
      const { x, y } = this.hits.toPixel(point[scene.axes.x], point[scene.axes.y]);
      if (!(x >= frame.x - 1 && x <= frame.x + frame.width + 1 && y >= frame.y - 1 && y <= frame.y + frame.height + 1)) return;
      context.strokeStyle = theme.ink;
      context.globalAlpha = 0.35;
      context.beginPath();
      context.moveTo(frame.x, y);
      context.lineTo(frame.x + frame.width, y);
      context.moveTo(x, frame.y);
      context.lineTo(x, frame.y + frame.height);
      context.stroke();
      context.globalAlpha = 1;
      context.beginPath();
      context.arc(x, y, i === scene.active ? 8 : 6, 0, 2 * Math.PI);
      context.fillStyle = theme.background;
      context.fill();
      context.lineWidth = i === scene.active ? 3 : 1.5;
      context.strokeStyle = theme.accent;
      context.stroke();
      if (scene.points.length > 1) {
        context.fillStyle = theme.ink;
        context.font = "bold 11px system-ui, sans-serif";
        context.textAlign = "center";
        context.textBaseline = "middle";
        context.fillText("AB"[i], x, y + 0.5);
      }
    });
  }

  tipOf({ series, mark, x, y }) {
    const { scene, model } = this.app;
    const label = mark === null ? this.names[series] : this.description.marks[mark].label;
    const symbol = (name) => parameterOf(model, name)?.symbol ?? name;
    const at = `${symbol(scene.axes.x)} = ${short(x)}, ${symbol(scene.axes.y)} = ${short(y)}`;
    const words = label ? explained(label) : null;
    return [label, at, words].filter(Boolean).join(" · ");
  }

  dataAt(event) {
    const at = this.hits?.toData(...this.at(event), 0);
    return at && Number.isFinite(at.x) && Number.isFinite(at.y) ? at : null;
  }

  down(event) {
    if (event.button !== 0 || !this.hits) return;
    const [px, py] = this.at(event);
    const frame = this.hits.frames[0];
    if (px < frame.x || px > frame.x + frame.width || py < frame.y || py > frame.y + frame.height) return;
    const { scene } = this.app;
    const away = scene.points.map((point) => {
      const { x, y } = this.hits.toPixel(point[scene.axes.x], point[scene.axes.y]);
      return Math.hypot(x - px, y - py);
    });
    const near = away.indexOf(Math.min(...away));
    this.drag = away[near] < 14 ? near : scene.active;
    this.canvas.setPointerCapture(event.pointerId);
    this.canvas.focus();
    this.app.movePoint(this.drag, this.dataAt(event), false);
  }

  move(event) {
    if (this.drag === null) return;
    this.tip.hidden = true;
    // The newest of the positions that came since the last frame.
    const data = this.dataAt(event);
    if (data) this.app.movePoint(this.drag, data, false);
  }

  up(event) {
    if (this.drag === null) return;
    const data = this.dataAt(event);
    const index = this.drag;
    this.drag = null;
    this.app.movePoint(index, event.type === "pointerup" ? data : null, true);
    this.compose();
  }

  key(event) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!step || !this.hits) return;
    event.preventDefault();
    const { scene } = this.app;
    const point = scene.points[scene.active];
    const frame = this.hits.frames[0];
    const { x, y } = this.hits.toPixel(point[scene.axes.x], point[scene.axes.y]);
    const size = KEY_STEP * (event.shiftKey ? 10 : 1);
    this.app.movePoint(scene.active, this.hits.toData(x + step[0] * size * frame.width, y + step[1] * size * frame.height, 0), true);
  }

  /** Zooming changes the ranges of the axes: curves are then computed there. */
  zoom({ x, y }) {
    this.app.setRanges(x, y);
  }

  resetZoom() {
    this.app.setRanges(null, null);
  }

  csv() {
    const parts = [...this.curves.values()].map((answer) => {
      const kept = this.answer;
      this.answer = answer;
      const text = super.csv();
      this.answer = kept;
      return text;
    });
    return parts.join("\n");
  }
}

/** The special points of an answer, as objects with the names of its columns. */
export function specialOf(answer) {
  const named = (columns, row) => Object.fromEntries(columns.map((name, i) => [name, row[i]]));
  if (answer.special) return answer.special.rows.map((row) => named(answer.special.columns, row));
  const value = (x) => (x !== null && typeof x === "object" ? x.value : x);
  const all = answer.result?.special ?? [];
  return all.map((one) => Object.fromEntries(Object.entries(one).map(([name, x]) => [name, value(x)])));
}
