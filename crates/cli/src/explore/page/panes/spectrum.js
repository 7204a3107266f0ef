// Eigenvalues of the equilibria and multipliers of the orbit, in the complex plane, with their bounds.

import { element } from "../elements.js";
import { commandLine } from "../out.js";
import { bounded, Pane } from "./pane.js";
import { COLOURS, lineOf, markOf, panelOf, rangeAround } from "./panels.js";

const SYMBOLS = ["circle", "square", "diamond", "triangle", "star"];
/** Equilibria beyond these have no symbol of their own. */
const DRAWN = 5;

/** The nontrivial multipliers of an orbit, each with its value and what is known of its size. Under a forcing none is trivial. */
function multipliersOf(orbit) {
  const logs = orbit?.log_multipliers ?? [];
  const first = (orbit?.multipliers?.length ?? 0) - logs.length;
  return logs.map((one, i) => ({
    value: orbit.multipliers?.[first + i] ?? null,
    log: one.ln_abs,
    most: one.ln_abs_at_most,
    angle: one.angle_over_pi,
    kind: one.kind,
  }));
}

export class SpectrumPane extends Pane {
  constructor(app, index) {
    super(app, { title: "Eigenvalues and multipliers", name: "spectrum", height: 420 });
    this.index = index;
    this.table = element("div", { class: "numbers" });
    this.words.append(this.table);
  }

  takeEquilibria(answer) {
    this.states = answer?.error ? [] : (answer?.result?.equilibria ?? []);
    if (answer && this.take(answer)) this.compose();
  }

  takeOrbit(answer) {
    if (!this.app.model.rests && answer) this.take(answer);
    this.orbit = answer?.error ? null : (answer?.result?.orbit ?? null);
    this.orbitAnswer = answer;
    this.compose();
  }

  /** The unit circle is round: the ranges follow the frame that the drawing has. */
  drawNow() {
    super.drawNow();
    const last = this.hits?.frames.at(-1);
    if (!this.size || !this.description || !last) return;
    this.ranges = this.hits.frames.map((frame, i) => (i === this.hits.frames.length - 1 ? evenRanges(frame, this.size) : null));
    super.drawNow();
  }

  resetZoom() {}

  /** Eigenvalues, and the logarithms of multipliers, a row each. */
  csv() {
    const lines = [`# ${commandLine(this.answer.command, this.answer.options)}`, "of,what,real,imaginary,uncertainty"];
    (this.states ?? []).filter((one) => one.eigenvalues).map(flat).forEach((state, i) => {
      const name = state.symmetry ?? `equilibrium ${i + 1}`;
      state.eigenvalues.forEach(([re, im], k) => lines.push([name, "eigenvalue", re, im, state.eigenvalue_uncertainty?.[k] ?? ""].join()));
    });
    for (const { log, angle } of multipliersOf(this.orbit)) {
      if (log) lines.push(["orbit", "ln multiplier", log.value, Math.PI * (angle ?? 0), log.uncertainty ?? ""].join());
    }
    return `${lines.join("\n")}\n`;
  }

  compose() {
    this.size = null;
    this.ranges = null;
    const states = (this.states ?? []).filter((one) => one.eigenvalues).map(flat);
    const panels = [];
    const rows = [];
    const unit = this.answer?.object?.units?.eigenvalue;
    if (states.length) {
      const all = states.slice(0, DRAWN).flatMap((one) => one.eigenvalues);
      const axis = (part, label) => ({ label, log: false, range: rangeAround([all.map((pair) => pair[part]), [0]]) });
      const named = (text) => (unit ? `${text} [${unit}]` : text);
      const panel = panelOf(axis(0, named("real part")), axis(1, named("imaginary part")));
      panel.zero_line = true;
      panel.series.push(lineOf("", [0, 0], panel.y.range, "#888888", { width: 1, stroke: "dotted" }));
      states.forEach((state, i) => {
        const name = state.symmetry ?? `equilibrium ${i + 1}`;
        const style = { symbol: SYMBOLS[i % SYMBOLS.length], filled: state.verdict === "stable", colour: COLOURS[i % DRAWN] };
        state.eigenvalues.forEach(([re, im], k) => {
          const bound = state.eigenvalue_uncertainty?.[k] ?? null;
          if (i < DRAWN) {
            const bars = bound ? { x: [re - bound, re + bound], y: [im - bound, im + bound] } : null;
            panel.marks.push(markOf(re, im, "", { ...style, bars }));
          }
          rows.push([name, state.kinds[k], complex(re, im, bound), re < 0 ? "decays" : re > 0 ? "grows" : "neutral"]);
        });
        if (i < DRAWN && states.length > 1) panel.keys.push({ symbol: style.symbol, filled: style.filled, colour: style.colour, label: name });
      });
      panel.title = "eigenvalues";
      panels.push(panel);
    }
    const multipliers = multipliersOf(this.orbit);
    if (multipliers.length) {
      const drawn = multipliers.filter((one) => one.value);
      const reach = Math.max(1.25, ...drawn.map(({ value }) => 1.1 * Math.hypot(...value)));
      const far = reach > 1e6;
      const size = far ? 1.25 : reach;
      this.size = size;
      const axis = (label) => ({ label, log: false, range: [-size, size] });
      const panel = panelOf(axis("real part"), axis("imaginary part"));
      const angles = Array.from({ length: 121 }, (_, k) => (k * 2 * Math.PI) / 120);
      panel.series.push(lineOf("|multiplier| = 1", angles.map(Math.cos), angles.map(Math.sin), "#888888", { width: 1 }));
      panel.marks.push(markOf(1, 0, "", { symbol: "cross", colour: "#888888" }));
      for (const { value } of drawn) panel.marks.push(markOf(...value, "", { symbol: "circle", filled: Math.hypot(...value) < 1, colour: COLOURS[1] }));
      panel.title = "multipliers";
      panels.push(panel);
      multipliers.forEach((one, i) => {
        const size = one.log ? `ln|µ| = ${bounded(one.log.value, one.log.uncertainty)}` : `ln|µ| ≤ ${bounded(one.most)}`;
        const angle = one.angle ? `, angle ${bounded(one.angle)} π` : "";
        const verdict = one.log ? (one.log.value < 0 ? "decays" : "grows") : "decays";
        rows.push(["orbit", `multiplier ${i + 1}`, size + angle, verdict]);
      });
    }
    this.table.replaceChildren(rows.length ? tableOf(rows) : "");
    this.canvas.setAttribute("aria-label", `Eigenvalues and multipliers in the complex plane: ${rows.length} numbers, listed below`);
    if (!panels.length) return this.show(null);
    this.canvas.style.height = `${panels.length === 1 ? 230 : 420}px`;
    this.show({ size: [420 * panels.length, 300], blocks: [{ title: "", columns: panels.map((panel) => [panel]) }] });
  }
}

/** An equilibrium with its eigenvalues as pairs, also those of many interfaces, which come with their multiplicity. */
function flat(state) {
  const pair = (one) => (Array.isArray(one) ? one : one.value);
  const of = (one) => (Array.isArray(one) || one.multiplicity === 1 ? "eigenvalue" : `eigenvalue, ${one.multiplicity} times`);
  return { ...state, eigenvalues: state.eigenvalues.map(pair), kinds: state.eigenvalues.map(of) };
}

/** Ranges around the same middle that make a frame's units as long on one axis as on the other. */
function evenRanges({ width, height }, size) {
  const long = Math.max(width, height) / Math.min(width, height);
  const [x, y] = width > height ? [size * long, size] : [size, size * long];
  return { x: [-x, x], y: [-y, y] };
}

function complex(re, im, bound) {
  const imaginary = im === 0 ? "" : ` ${im < 0 ? "-" : "+"} ${bounded(Math.abs(im))} i`;
  return im === 0 ? bounded(re, bound) : `${bounded(re)}${imaginary}${bound ? ` ± ${bound.toExponential(0)}` : ""}`;
}

function tableOf(rows) {
  const head = ["of", "what", "value", ""].map((text) => element("th", { scope: "col" }, text));
  const body = rows.map((row) => element("tr", {}, ...row.map((text) => element("td", {}, text))));
  const table = element("table", {}, element("thead", {}, element("tr", {}, ...head)), element("tbody", {}, ...body));
  return element("details", {}, element("summary", {}, `${rows.length} numbers`), table);
}
