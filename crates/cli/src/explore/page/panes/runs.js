// The run in time, its portrait, and the return map, each at one of the points.

import { pngOf } from "../draw/surface.js";
import { button, element, labelled } from "../elements.js";
import { download } from "../out.js";
import { Pane, short } from "./pane.js";
import { COLOURS, dotsOf, lineOf, markOf, panelOf, rangeAround } from "./panels.js";
import { Portrait3d } from "../solid/turn.js";
import { explained } from "../glossary.js";

/** Panels of such a picture, one above the other. */
const PANELS = 3;

/** The colours of the interfaces in pictures of runs. */
const OF_INTERFACES = [COLOURS[1], COLOURS[0], COLOURS[2], COLOURS[3]];

/** What a run that has no picture, amid a drag or as it broke off, shows: the panels of the program's picture. */
function panelsOfRun(answer, model) {
  const time = answer.column("time");
  const axis = (label, range, log = false) => ({ label, log, range });
  const unit = (name) => {
    const known = answer.units[answer.columns.indexOf(name)];
    return known ? ` [${known}]` : "";
  };
  const across = axis(`time t${unit("time")}`, rangeAround([time]));
  const several = (title, symbol, names) => {
    const lists = names.map((name) => answer.column(name));
    const panel = panelOf(across, axis(`${title} ${symbol}${unit(names[0])}`, rangeAround(lists, true), true));
    names.forEach((_, i) => {
      const stroke = i === 0 ? "solid" : "dashed";
      panel.series.push(lineOf(names.length > 1 ? `${symbol}_${i + 1}` : "", time, lists[i], OF_INTERFACES[i % 4], { stroke }));
    });
    return panel;
  };
  const one = (name, label) => {
    const list = answer.column(name);
    const panel = panelOf(across, axis(label, rangeAround([list])));
    panel.series.push(lineOf("", time, list, COLOURS[0]));
    return panel;
  };
  const numbered = (prefix) => answer.columns.filter((name) => new RegExp(`^${prefix}_\\d+$`).test(name));
  const [states, rates] = [numbered("state"), numbered("slip_rate")];
  const column =
    model.kind === "interfaces" && states.length && rates.length
      ? [one("stress", `stress τ${unit("stress")}`), several("state", "ψ", states), several("slip rate", "v", rates)]
      : model.states.filter(({ name }) => answer.column(name)).slice(0, PANELS).map(({ name, label }) => one(name, label));
  return { size: [400, 200 * column.length], blocks: [{ title: "", columns: [column] }] };
}

/** The first column of panels of a picture: what is drawn against time. */
function firstColumn(picture) {
  const blocks = picture.blocks.map((block) => ({ ...block, columns: block.columns.slice(0, 1) }));
  const panels = blocks.flatMap((block) => block.columns.flat());
  // Titles would say again where the point is.
  for (const panel of panels) panel.title = "";
  const heights = panels.map((panel) => panel.frame[1] + 70);
  return { size: [picture.size[0] / 2, heights.reduce((a, b) => a + b, 0)], blocks };
}

export class RunPane extends Pane {
  constructor(app, index) {
    super(app, { title: "Run in time", name: "run", height: 470 });
    this.index = index;
  }

  /** Says that nothing tells how long a run is of interest. */
  ask() {
    this.problem.textContent = "Neither an equilibrium nor an orbit says how long a run is of interest: give its end, Until.";
    this.problem.hidden = false;
    this.show(null);
  }

  takeRun(answer) {
    // A run that breaks off has come so far.
    if (!this.take(answer) && answer.rows.length < 2) return;
    const picture = answer.pictures.at(-1);
    this.show(picture ? firstColumn(picture) : panelsOfRun(answer, this.app.model));
    const [rows, last] = [answer.rows.length, answer.column("time")?.at(-1)];
    const unit = answer.units[answer.columns.indexOf("time")];
    const told = answer.says.filter((text) => /^(warning|note)/.test(text));
    this.words.textContent = told.join(" ");
    this.canvas.setAttribute("aria-label", `Run in time: ${rows} rows to time ${short(last)}${unit ? ` ${unit}` : ""}`);
  }
}

/** At a distance of so many pixels or less, a click is no drag. */
const CLICK = 4;

export class PortraitPane extends Pane {
  constructor(app, index) {
    super(app, { title: "Phase portrait", name: "portrait", height: 320 });
    this.index = index;
    this.choices = [0, 1, 2].map((i) => {
      const select = element("select", { "aria-label": `${"xyz"[i]} axis of the portrait` });
      select.addEventListener("change", () => this.app.setPortrait(this.choices.map((one) => one.value).filter(Boolean)));
      return select;
    });
    this.pickButton = button("Pick start", () => this.picking(!this.picks), {
      "aria-pressed": "false",
      title: "Then click in the portrait: runs start there",
    });
    this.heading.after(element("span", { class: "choices" }, ...this.choices), this.pickButton);
    this.solid = element("canvas", { class: "solid", tabindex: "0", role: "img", "aria-label": "Phase portrait", hidden: true });
    this.solid.style.height = "320px";
    this.body.append(this.solid);
    this.canvas.addEventListener("pointerdown", (event) => (this.pressed = this.at(event)));
    this.canvas.addEventListener("pointerup", (event) => this.click(event));
    this.solid.addEventListener("pointerdown", (event) => (this.pressed = this.at(event)));
    this.solid.addEventListener("pointerup", (event) => this.click(event));
    new ResizeObserver(() => this.turnable?.draw()).observe(this.solid);
  }

  picking(on) {
    this.picks = on;
    this.pickButton.setAttribute("aria-pressed", String(on));
    this.element.classList.toggle("picks", on);
  }

  /** Columns that can be axes. */
  names() {
    const skip = /^(time|slip_\d+|driving|n)$/;
    return this.answer ? this.answer.columns.filter((name) => !skip.test(name) && !/_uncertainty$/.test(name)) : [];
  }

  offer() {
    const names = this.names();
    const states = this.app.model.states.map((one) => one.name).filter((name) => names.includes(name));
    const chosen = (this.app.scene.portrait ?? states.slice(0, 3)).filter((name) => names.includes(name));
    this.axes = chosen.length >= 2 ? chosen : states.length >= 2 ? states.slice(0, 2) : names.slice(0, 2);
    const list = names.join();
    this.choices.forEach((select, i) => {
      if (select.dataset.names !== list) {
        const options = names.map((name) => element("option", { value: name }, name.replaceAll("_", " ")));
        if (i === 2) options.unshift(element("option", { value: "" }, "none"));
        select.replaceChildren(...options);
        select.dataset.names = list;
      }
      select.value = this.axes[i] ?? "";
      select.hidden = i === 2 && names.length < 3;
    });
  }

  label(name) {
    const state = this.app.model.states.find((one) => one.name === name);
    const unit = this.answer.units[this.answer.columns.indexOf(name)];
    return state?.label ?? (unit ? `${name.replaceAll("_", " ")} [${unit}]` : name.replaceAll("_", " "));
  }

  takeRun(answer) {
    if (!this.take(answer) && answer.rows.length < 2) return;
    this.compose();
  }

  takeEquilibria(answer) {
    this.states = answer?.error ? [] : (answer?.result?.equilibria ?? []);
    if (this.answer && !this.answer.error) this.compose();
  }

  /** The value of a column at an equilibrium. */
  valueAt(state, name) {
    const own = state[name];
    if (own !== undefined) return typeof own === "object" && own !== null ? own.value : own;
    const indexed = /^(state|log_state|slip_rate)_(\d+)$/.exec(name);
    return indexed ? (state[indexed[1]]?.[Number(indexed[2]) - 1] ?? null) : null;
  }

  compose() {
    if (!this.answer?.columns.length) return;
    this.offer();
    const columns = this.axes.map((name) => this.answer.column(name));
    const log = this.axes.map((name, i) => /^(slip_rate|state)_/.test(name) && columns[i].every((x) => x > 0));
    const points = (this.states ?? []).map((state) => ({
      at: this.axes.map((name) => this.valueAt(state, name)),
      stable: state.verdict === "stable",
    }));
    this.canvas.hidden = this.axes.length > 2;
    this.solid.hidden = this.axes.length <= 2;
    if (this.axes.length > 2) return this.compose3d(columns, log, points);
    const range = columns.map((list, i) => rangeAround([list], log[i]));
    const axis = (i) => ({ label: this.label(this.axes[i]), log: log[i], range: range[i] });
    const panel = panelOf(axis(0), axis(1));
    panel.series.push(lineOf("", columns[0], columns[1], COLOURS[0], { width: 1.2 }));
    const symbol = (stable) => ({ symbol: "circle", filled: stable, colour: COLOURS[1] });
    for (const { at, stable } of points) {
      if (at.every((x) => x !== null)) panel.marks.push(markOf(at[0], at[1], "", symbol(stable)));
    }
    panel.marks.push(markOf(columns[0][0], columns[1][0], "start", { symbol: "square", colour: COLOURS[2] }));
    this.show(panel);
    this.canvas.setAttribute("aria-label", `Phase portrait of ${this.axes.join(" and ")}; ${points.length} equilibria`);
  }

  compose3d(columns, log, points) {
    const scaled = columns.map((list, i) => (log[i] ? list.map((x) => Math.log10(x)) : list));
    const [x, y, z] = scaled;
    const labels = this.axes.map((name, i) => (log[i] ? `log10 ${this.label(name)}` : this.label(name)));
    const place = (at) => at.map((value, i) => (log[i] ? Math.log10(value) : value));
    const marks = points.filter(({ at }) => at.every((value) => value !== null)).map(({ at, stable }) => {
      const [px, py, pz] = place(at);
      return { x: px, y: py, z: pz, symbol: "circle", filled: stable, colour: COLOURS[1], label: "" };
    });
    marks.push({ x: x[0], y: y[0], z: z[0], symbol: "square", filled: true, colour: COLOURS[2], label: "start" });
    const content = { labels, curves: [{ x, y, z, colour: COLOURS[0], label: "" }], marks };
    this.solid.setAttribute("aria-label", `Phase portrait of ${this.axes.join(", ")}, turned by arrow keys`);
    if (this.turnable) this.turnable.set(content, this.view());
    else this.turnable = new Portrait3d(this.solid, content, () => this.view());
    this.description = null;
  }

  view() {
    const shown = this.axes?.length > 2 ? this.solid : this.canvas;
    const box = shown.getBoundingClientRect();
    return { ...super.view(), width: Math.max(box.width, 50), height: Math.max(box.height, 50) };
  }

  redraw() {
    if (this.axes?.length > 2) this.turnable?.draw();
    else super.redraw();
  }

  at(event) {
    const box = event.currentTarget.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  svg() {
    return this.axes?.length > 2 ? (this.turnable?.svg(this.view()) ?? null) : super.svg();
  }

  async savePng() {
    if (!(this.axes?.length > 2)) return super.savePng();
    return download(`${this.name}.png`, await pngOf(this.solid), "image/png");
  }

  /** A start where the click is: in three dimensions at the nearest point of the run, in two with the other states as they are. */
  click(event) {
    const [px, py] = this.at(event);
    if (!this.picks || !this.pressed || Math.hypot(px - this.pressed[0], py - this.pressed[1]) > CLICK) return;
    const answer = this.answer;
    const row = answer?.rows[0];
    if (!row) return;
    if (this.axes.length > 2) {
      const near = this.turnable.nearest(px, py);
      if (!near) return;
      this.app.setStart(this.startOf(answer.rows[near.index], {}));
    } else {
      const at = this.hits?.toData(px, py);
      if (!at) return;
      this.app.setStart(this.startOf(row, { [this.axes[0]]: at.x, [this.axes[1]]: at.y }));
    }
    this.picking(false);
  }

  /** The start as the program takes it: of interfaces the stress and psi of each. */
  startOf(row, given) {
    const { columns } = this.answer;
    const value = (name) => row[columns.indexOf(name)];
    return this.app.model.states.map(({ name }) => {
      const log = /^log_state_(\d+)$/.exec(name);
      if (!log) return given[name] ?? value(name);
      const own = `state_${log[1]}`;
      if (given[own] !== undefined) return given[own];
      // In whatever unit the state is.
      if (given[name] !== undefined) return value(own) * Math.exp(given[name] - value(name));
      return value(own);
    });
  }
}

export class ReturnsPane extends Pane {
  constructor(app, index) {
    super(app, { title: "Return map", name: "returns", height: 280 });
    this.index = index;
    this.surface = element("input", { type: "text", size: "12", "aria-label": "Section of the return map", placeholder: "section" });
    this.surface.addEventListener("change", () => app.setSurface(this.surface.value.trim() || null));
    this.heading.after(labelled("at ", this.surface, { class: "inline" }));
  }

  takeSection(answer) {
    const { rests, surface } = this.app.model;
    this.surface.placeholder = rests ? (surface ?? "stress=auto") : "each period";
    if (document.activeElement !== this.surface) this.surface.value = this.app.scene.surface ?? "";
    if (!this.take(answer)) return;
    const picture = answer.pictures.at(-1);
    if (picture) {
      // What stands beside the map, the states at the returns, is a portrait.
      this.show(firstColumn(picture));
    } else if (answer.ended || answer.error) this.show(answer.rows.length ? this.ownMap(answer) : null);
    const regime = answer.result?.regime;
    if (regime) {
      this.words.textContent = `${answer.rows.length} returns: ${regime}`;
      this.words.title = explained(regime) ?? "";
      this.canvas.setAttribute("aria-label", `Return map: ${this.words.textContent}`);
    }
  }

  /** The next return of the first state that varies against this one. */
  ownMap(answer) {
    const varies = (name) => {
      const list = answer.column(name);
      return Math.max(...list) > Math.min(...list);
    };
    const name = this.app.model.states.map((one) => one.name).find((one) => answer.column(one) && varies(one)) ?? "time";
    const list = answer.column(name);
    const [x, y] = [list.slice(0, -1), list.slice(1)];
    const range = rangeAround([list]);
    const panel = panelOf({ label: `${name} at return n`, log: false, range }, { label: `${name} at return n + 1`, log: false, range });
    panel.series.push(lineOf("diagonal", range, range, COLOURS[1], { width: 1 }), dotsOf("", x, y, COLOURS[0]));
    return panel;
  }
}
