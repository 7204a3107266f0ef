// The bifurcation diagram along one parameter through the point: equilibria, and periodic orbits by their extremes.

import { element } from "../elements.js";
import { term } from "../glossary.js";
import { Pane, short } from "./pane.js";
import { axisLabel, COLOURS, lineOf, markOf, panelOf, rangeAroundMost } from "./panels.js";
import { parameterOf, rangeOf } from "../scene.js";
import { specialOf } from "./diagram.js";

const STROKES = { stable: "solid", unstable: "dashed" };

/** Pieces of branches on which the verdict is one: lists of places in the rows. */
function pieces(answer) {
  const branch = answer.columns.indexOf("branch");
  const verdict = answer.columns.indexOf("verdict");
  const label = answer.columns.indexOf("label");
  const all = [];
  let before = null;
  answer.rows.forEach((row, i) => {
    const last = all.at(-1);
    const same = before && before[branch] === row[branch];
    // At a bifurcation itself nothing is decided: it belongs to what comes before.
    if (same && (last.verdict === row[verdict] || (row[label] && row[verdict] === "undecided"))) last.places.push(i);
    else {
      // Pieces of one branch touch: the next one begins where the last ended.
      const places = same ? [i - 1, i] : [i];
      all.push({ verdict: row[verdict], places });
    }
    before = row;
  });
  return all;
}

export class BranchPane extends Pane {
  /** `which` is x or y: the axis of the diagram along which it runs. */
  constructor(app, which) {
    super(app, { title: "Along a parameter", name: `along-${which}`, height: 230 });
    this.which = which;
    this.answers = {};
    this.choice = element("select", { "aria-label": "Quantity" });
    this.choice.addEventListener("change", () => this.compose());
    this.heading.after(this.choice);
    this.over = element("canvas", { class: "over", "aria-hidden": "true" });
    this.canvas.addEventListener("click", (event) => this.pick(event));
  }

  get along() {
    return this.app.scene.axes[this.which];
  }

  clear() {
    this.answers = {};
    const one = parameterOf(this.app.model, this.along);
    if (one) this.heading.textContent = `Along ${one.symbol ?? one.name}`;
    this.offer();
    this.compose();
  }

  /** The quantities that can be drawn: states, and the period of orbits. */
  offer() {
    const { model } = this.app;
    const names = model.kind === "interfaces" ? ["stress", "period"] : [...model.states.map((one) => one.name), "period"];
    if (this.choice.dataset.names === names.join()) return;
    this.choice.dataset.names = names.join();
    this.choice.replaceChildren(...names.map((name) => element("option", { value: name }, name.replaceAll("_", " "))));
  }

  takeBranch(of, answer) {
    const none = answer.error?.kind === "numerical" && /no .*(found|met)/.test(answer.error.message);
    if (none) this.answers[of] = null;
    else {
      this.take(answer);
      this.answers[of] = answer;
    }
    this.compose();
  }

  compose() {
    const { scene, model } = this.app;
    const along = parameterOf(model, this.along);
    if (!along) return;
    const name = this.choice.value;
    const range = rangeOf(scene, model, this.along);
    const state = model.states.find((one) => one.name === name);
    const series = [];
    const marks = [];
    const strokes = new Map();
    for (const [of, colour] of [["equilibria", COLOURS[0]], ["orbits", COLOURS[1]]]) {
      const answer = this.answers[of];
      if (!answer) continue;
      const x = answer.column(this.along);
      const own = answer.column(name);
      const ends = [answer.column(`${name}_min`), answer.column(`${name}_max`)];
      const lists = of === "orbits" && name !== "period" && ends[0] ? ends : own ? [own] : [];
      if (!x) continue;
      let label = of === "orbits" ? "periodic orbits" : "equilibria";
      if (of === "equilibria" && name === "period") continue;
      for (const { verdict, places } of pieces(answer)) {
        const stroke = STROKES[verdict] ?? "dotted";
        strokes.set(stroke, verdict === "stable" ? "stable" : verdict === "unstable" ? "unstable" : "undecided");
        for (const list of lists) {
          series.push(lineOf(label, places.map((i) => x[i]), places.map((i) => list[i]), colour, { stroke }));
          label = "";
        }
      }
      const labels = answer.column("label") ?? [];
      labels.forEach((text, i) => {
        if (!text || text === "EP" || text === "UZ" || !lists.length) return;
        marks.push(markOf(x[i], lists.at(-1)[i], text, { colour }));
      });
    }
    const log = along.log && range[0] > 0;
    const values = series.flatMap((one) => one.y);
    const logY = name === "period" && values.length > 0;
    const label = state?.label ?? name.replaceAll("_", " ");
    const panel = panelOf({ label: axisLabel(along), log, range }, { label, log: logY, range: rangeAroundMost([values], logY) });
    Object.assign(panel, { series, marks });
    if (strokes.size > 1) panel.strokes = [...strokes].map(([stroke, words]) => ({ stroke, label: words }));
    const found = ["equilibria", "orbits"].flatMap((of) => (this.answers[of] ? specialOf(this.answers[of]) : []));
    const points = found.filter((one) => !["EP", "UZ"].includes(one.label));
    const told = [...new Set(points.map((one) => `${one.label} at ${short(one[this.along])}`))];
    const words = told.flatMap((text, i) => [i ? ", " : "", term(text.split(" ")[0]), text.slice(text.indexOf(" "))]);
    this.words.replaceChildren(...words);
    this.canvas.setAttribute("aria-label", `Branches along ${along.symbol ?? along.name}: ${told.join(", ") || "no bifurcation yet"}`);
    this.show(panel);
  }

  /** Where the point is. */
  overlay(surface, view) {
    if (!this.hits?.panels.length) return;
    const { scene } = this.app;
    const context = this.canvas.getContext("2d", { willReadFrequently: true });
    const frame = this.hits.frames[0];
    scene.points.forEach((point, i) => {
      const { x } = this.hits.toPixel(point[this.along], 1);
      if (!(x >= frame.x && x <= frame.x + frame.width)) return;
      context.save();
      context.strokeStyle = view.theme.accent;
      context.globalAlpha = i === scene.active ? 0.8 : 0.4;
      context.beginPath();
      context.moveTo(x, frame.y);
      context.lineTo(x, frame.y + frame.height);
      context.stroke();
      context.restore();
    });
  }

  pick(event) {
    const at = this.hits?.toData(...this.at(event), 0);
    const frame = this.hits?.frames[0];
    const [px] = this.at(event);
    if (!at || px < frame.x || px > frame.x + frame.width) return;
    this.app.setValue(this.along, Number(at.x.toPrecision(6)));
  }

  csv() {
    const kept = this.answer;
    const parts = ["equilibria", "orbits"].filter((of) => this.answers[of]).map((of) => {
      this.answer = this.answers[of];
      return super.csv();
    });
    this.answer = kept;
    return parts.join("\n");
  }
}
