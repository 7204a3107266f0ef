// A loading program: the driving velocity against time, drawn by hand or written as the program takes it.

import { button, element } from "../elements.js";
import { short, themeOf } from "./pane.js";
import { rangeOf, valuesAt } from "../scene.js";

const HEIGHT = 110;
const MARGIN = 8;

/** The changes of a program in text, `T:V` for steps and `T1-T2:V` for ramps; null where it has another form. */
export function changesOf(text) {
  const number = "[0-9.]+(?:e[-+]?[0-9]+)?";
  const form = new RegExp(`^(${number})(?:-(${number}))?:(${number})$`, "i");
  const changes = [];
  for (const part of text.split(",").map((one) => one.trim()).filter(Boolean)) {
    const found = form.exec(part);
    if (!found) return null;
    changes.push({ from: Number(found[1]), to: Number(found[2] ?? found[1]), value: Number(found[3]) });
  }
  return changes;
}

/** A line drawn by hand, as ramps between few of its points: those off the straight line by more than a part of the height. */
export function programOf(points, tolerance = 0.03) {
  const kept = [points[0]];
  const simplify = (from, to) => {
    let [far, place] = [tolerance, -1];
    for (let i = from + 1; i < to; i++) {
      const part = (points[i].part - points[from].part) / (points[to].part - points[from].part || 1);
      const off = Math.abs(points[i].height - (points[from].height + part * (points[to].height - points[from].height)));
      if (off > far) [far, place] = [off, i];
    }
    if (place < 0) kept.push(points[to]);
    else {
      simplify(from, place);
      simplify(place, to);
    }
  };
  if (points.length > 1) simplify(0, points.length - 1);
  const written = (x) => String(Number(x.toPrecision(3)));
  const changes = [];
  let last = 0;
  for (const { time, value } of kept) {
    const at = Number(written(time));
    if (at < last || (changes.length && at === last)) continue;
    changes.push(changes.length ? `${written(last)}-${written(at)}:${written(value)}` : `${written(at)}:${written(value)}`);
    last = at;
  }
  return changes.join(",");
}

export class ProgramField {
  constructor(app) {
    this.app = app;
    this.text = element("input", { type: "text", placeholder: "10:0,20:1", spellcheck: "false", "aria-label": "Program of the driving velocity, T:V for a step and T1-T2:V for a ramp" });
    this.canvas = element("canvas", { class: "program", role: "img", "aria-label": "Driving velocity against time; drag to draw" });
    this.canvas.style.height = `${HEIGHT}px`;
    const clear = button("Clear", () => app.change({ program: "" }));
    this.element = element(
      "details",
      { class: "program-field" },
      element("summary", {}, "Program of V_H"),
      element("p", { class: "hint" }, "Drag to draw the driving velocity, from left to right; or write steps T:V, holds T:0 and ramps T1-T2:V."),
      this.canvas,
      this.text,
      clear,
    );
    this.text.addEventListener("change", () => app.change({ program: this.text.value.trim() }));
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.line = null;
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      this.line = [this.at(event)];
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!this.line) return;
      const at = this.at(event);
      if (at.part > this.line.at(-1).part) this.line.push(at);
      this.draw();
    });
    this.canvas.addEventListener("pointerup", () => {
      const line = this.line;
      this.line = null;
      if (line?.length) app.change({ program: programOf(line) });
    });
    this.canvas.addEventListener("pointercancel", () => (this.line = null));
  }

  /** The range of the velocity: the slider's, of which the lowest is a hold. */
  get range() {
    const [lo, hi] = rangeOf(this.app.scene, this.app.model, "driving");
    return [lo > 0 ? lo : hi * 1e-6, hi];
  }

  at(event) {
    const box = this.canvas.getBoundingClientRect();
    const part = Math.min(Math.max((event.clientX - box.left - MARGIN) / (box.width - 2 * MARGIN), 0), 1);
    const height = 1 - Math.min(Math.max((event.clientY - box.top - MARGIN) / (box.height - 2 * MARGIN), 0), 1);
    const [lo, hi] = this.range;
    return { part, height, time: part * this.app.untilShown, value: height < 0.03 ? 0 : lo * (hi / lo) ** height };
  }

  show(program) {
    if (document.activeElement !== this.text) this.text.value = program;
    this.draw();
  }

  draw() {
    const box = this.canvas.getBoundingClientRect();
    if (!box.width) return;
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = box.width * ratio;
    this.canvas.height = box.height * ratio;
    const context = this.canvas.getContext("2d", { willReadFrequently: true });
    context.scale(ratio, ratio);
    const theme = themeOf(this.canvas);
    const [lo, hi] = this.range;
    const until = this.app.untilShown;
    const x = (time) => MARGIN + (Math.min(time / until, 1) * (box.width - 2 * MARGIN));
    const y = (value) => {
      const height = value > lo ? Math.log(value / lo) / Math.log(hi / lo) : 0;
      return box.height - MARGIN - Math.min(height, 1) * (box.height - 2 * MARGIN);
    };
    context.strokeStyle = theme.accent;
    context.lineWidth = 2;
    context.beginPath();
    const { scene, model } = this.app;
    if (this.line) this.line.forEach(({ time, value }, i) => (i ? context.lineTo(x(time), y(value)) : context.moveTo(x(time), y(value))));
    else {
      let before = valuesAt(scene, model, scene.active).driving;
      context.moveTo(x(0), y(before));
      for (const { from, to, value } of changesOf(scene.program) ?? []) {
        context.lineTo(x(from), y(before));
        context.lineTo(x(to), y(value));
        before = value;
      }
      context.lineTo(x(until), y(before));
    }
    context.stroke();
    context.fillStyle = theme.muted;
    context.font = "11px system-ui, sans-serif";
    context.fillText(short(hi), MARGIN, MARGIN + 8);
    context.fillText(`hold    0 to ${short(until)}`, MARGIN, box.height - MARGIN);
  }
}
