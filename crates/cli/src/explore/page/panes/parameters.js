// The side of the page where the system and its parameters are chosen.

import { button, element, labelled } from "../elements.js";
import { short } from "./pane.js";
import { parameterOf, rangeOf, valuesAt } from "../scene.js";
import { ProgramField } from "./program.js";

/** Steps of a slider. */
const STEPS = 1000;

/** Digits of a value in its field; a click gives no more. */
const DIGITS = 7;
const GREEK = { eta: "η", sigma: "σ", mu: "μ", beta: "β", alpha: "α", gamma: "γ" };

/** A symbol with Greek letters. */
function typeset(symbol) {
  return symbol.replace(/^(eta|sigma|mu|beta|alpha|gamma)(?=_|$)/, (name) => GREEK[name]);
}

/** One parameter: its symbol, a slider over its range, and a field that takes numbers, with units in SI. */
class ParameterRow {
  constructor(app, one) {
    Object.assign(this, { app, one });
    const symbol = typeset(one.symbol ?? one.name);
    const words = one.meaning ? `${one.meaning}${one.unit ? ` [${one.unit}]` : ""}` : one.name;
    this.slider = element("input", { type: "range", min: "0", max: String(STEPS), step: "1", "aria-label": words });
    this.field = element("input", { type: "text", inputmode: "decimal", "aria-label": `${words}, value`, size: "9", spellcheck: "false" });
    this.slider.addEventListener("input", () => this.slid(false));
    this.slider.addEventListener("change", () => this.slid(true));
    this.field.addEventListener("change", () => this.typed());
    this.unit = element("span", { class: "unit" }, (one.unit ?? "").replace("sigma", "σ"));
    this.element = element("div", { class: "parameter", title: words }, element("span", { class: "symbol" }, symbol), this.slider, this.field, this.unit);
  }

  get range() {
    return rangeOf(this.app.scene, this.app.model, this.one.name);
  }

  show(value) {
    const [lo, hi] = this.range;
    const shown = `${value} ${lo} ${hi}`;
    if (shown === this.shown && !this.field.hasAttribute("aria-invalid")) return;
    this.shown = shown;
    const log = this.one.log && lo > 0 && value > 0;
    const part = log ? Math.log(value / lo) / Math.log(hi / lo) : (value - lo) / (hi - lo);
    this.slider.value = String(Math.round(STEPS * Math.min(Math.max(part, 0), 1)));
    this.slider.setAttribute("aria-valuetext", `${short(value)} ${this.one.unit ?? ""}`);
    this.field.value = String(Number(value.toPrecision(DIGITS)));
    this.field.removeAttribute("aria-invalid");
  }

  slid(done) {
    const [lo, hi] = this.range;
    const part = Number(this.slider.value) / STEPS;
    const log = this.one.log && lo > 0;
    const value = log ? lo * (hi / lo) ** part : lo + (hi - lo) * part;
    this.app.setValue(this.one.name, Number(value.toPrecision(5)), done);
  }

  async typed() {
    const text = this.field.value.trim();
    const value = Number(text);
    if (text !== "" && Number.isFinite(value)) return this.app.setValue(this.one.name, value);
    // A number with a unit is for the program to read.
    const read = text ? await this.app.readValue(this.one.name, text) : null;
    if (read === null) {
      this.field.setAttribute("aria-invalid", "true");
      this.app.say(`${this.one.symbol ?? this.one.name}: ${text || "nothing"} is no number${this.app.model.kind === "interfaces" ? " with a unit" : ""}.`);
    } else this.app.setValue(this.one.name, read);
  }
}

export class ParametersPane {
  constructor(app) {
    this.app = app;
    this.system = element("div", { class: "system" });
    this.axes = element("div", { class: "axes" });
    this.rows = element("div", { class: "parameters" });
    this.run = element("div", { class: "run-options" });
    this.element = element(
      "aside",
      { class: "side", "aria-label": "System and parameters" },
      element("h2", {}, "System"),
      this.system,
      element("h2", {}, "Parameters"),
      this.axes,
      this.rows,
      element("h2", {}, "Run"),
      this.run,
    );
  }

  /** Another system: everything anew. */
  rebuild() {
    const { model } = this.app;
    this.parameters = new Map(model.parameters.map((one) => [one.name, new ParameterRow(this.app, one)]));
    this.rows.replaceChildren(...[...this.parameters.values()].map((row) => row.element));
    this.system.replaceChildren(...this.systemFields());
    this.axes.replaceChildren(...this.axisFields());
    this.run.replaceChildren(...this.runFields());
    this.refresh();
  }

  /** The same system with other values. */
  refresh() {
    const { scene, model } = this.app;
    const values = valuesAt(scene, model, scene.active);
    for (const [name, row] of this.parameters) row.show(values[name]);
    for (const [which, select] of Object.entries(this.axisChoices ?? {})) select.value = scene.axes[which] ?? "";
    if (this.until && document.activeElement !== this.until) this.until.value = scene.until ?? "";
    if (this.until) this.until.placeholder = `auto (${short(this.app.untilShown)})`;
    if (this.start && document.activeElement !== this.start) this.start.value = scene.start?.map(short).join(", ") ?? "";
    if (this.symmetry) this.symmetry.value = scene.symmetry;
    this.program?.show(scene.program);
  }

  choice(label, options, value, act) {
    const select = element("select", { "aria-label": label }, ...options.map(([key, words]) => element("option", { value: key, title: words }, key)));
    select.value = value;
    select.addEventListener("change", () => act(select.value));
    return labelled(label, select);
  }

  systemFields() {
    const { app } = this;
    const { model, scene } = app;
    const fields = [];
    const kinds = [["interfaces", "Frictional interfaces in a slab"], ...app.systems.map((name) => [name, "A system that is built in"]), ["own", "Your own equations"]];
    const own = scene.given.system?.includes("\n") ? "own" : scene.given.system;
    const kind = model.kind === "interfaces" ? "interfaces" : own ?? "own";
    if (!kinds.some(([name]) => name === kind)) kinds.push([kind, kind]);
    fields.push(this.choice("System", kinds, kind, (name) => this.chosen(name)));
    if (model.kind === "interfaces") {
      const laws = model.laws.map((law) => [law.name, law.meaning]);
      const law = scene.given.law ?? laws[0]?.[0];
      if (laws.some(([name]) => name === law)) fields.push(this.choice("Law", laws, law, (name) => app.setGiven({ law: name })));
      const count = String(model.interfaces ?? 2);
      const counts = [...new Set(["1", "2", "3", "4", count])].sort().map((n) => [n, `${n} interfaces`]);
      fields.push(this.choice("Interfaces", counts, count, (n) => app.setGiven({ interfaces: Number(n), clusters: undefined })));
      const si = element("input", { type: "checkbox" });
      si.checked = Boolean(model.si);
      si.addEventListener("change", () => app.setUnits(si.checked));
      fields.push(labelled("SI units", si, { class: "check" }));
    } else {
      this.text = element("textarea", { rows: "10", spellcheck: "false", "aria-label": "Equations of the system, as a TOML file" });
      this.text.value = model.text ?? "";
      const use = button("Use these equations", () => app.setGiven({ system: `${this.text.value.trimEnd()}\n` }, true));
      fields.push(element("details", { open: own === "own" }, element("summary", {}, "Equations"), this.text, use));
    }
    const file = element("input", { type: "file", accept: ".json,application/json", "aria-label": "A fit to load" });
    file.addEventListener("change", async () => {
      const [chosen] = file.files;
      if (chosen) app.setFit(await chosen.text());
    });
    if (model.kind === "interfaces") {
      const unload = scene.fit ? button("Without the fit", () => app.setFit(null)) : null;
      fields.push(element("details", { open: Boolean(scene.fit) }, element("summary", {}, "A fit (fit.json)"), file, unload));
    }
    return fields;
  }

  chosen(name) {
    const { app } = this;
    if (name === "interfaces") app.setGiven({ system: undefined }, true);
    else if (name === "own") app.setGiven({ system: app.model.text ?? app.example }, true);
    else app.setGiven({ system: name }, true);
  }

  axisFields() {
    const { app } = this;
    const names = app.model.parameters.filter((one) => !one.integer).map((one) => [one.name, one.meaning ?? one.name]);
    this.axisChoices = {};
    const field = (which, label, options) => {
      const box = this.choice(label, options, app.scene.axes[which] ?? "", (name) => app.setAxis(which, name));
      this.axisChoices[which] = box.querySelector("select");
      return box;
    };
    if (names.length < 2) return [field("x", "Across", names)];
    return [field("x", "Across", names), field("y", "Up", names)];
  }

  runFields() {
    const { app } = this;
    this.until = element("input", { type: "text", inputmode: "decimal", size: "10", "aria-label": "End time of the run" });
    this.until.addEventListener("change", () => {
      const value = Number(this.until.value);
      app.change({ until: this.until.value.trim() !== "" && value > 0 ? value : null });
    });
    this.start = element("input", { type: "text", size: "22", placeholder: "near a steady state", "aria-label": "Start of the run, all states in order" });
    this.start.addEventListener("change", () => app.setStart(numbers(this.start.value, app)));
    const fields = [labelled("Until", this.until), labelled("Start", this.start)];
    if (app.model.kind === "system") this.start.placeholder = "of the file";
    if (app.model.symmetries.length) {
      const options = ["both", ...app.model.symmetries].map((name) => [name, `orbits and curves that are ${name}`]);
      const box = this.choice("Symmetry", options, app.scene.symmetry, (symmetry) => app.change({ symmetry }));
      this.symmetry = box.querySelector("select");
      fields.push(box);
    } else this.symmetry = null;
    this.program = app.model.kind === "interfaces" && parameterOf(app.model, "driving") ? new ProgramField(app) : null;
    if (this.program) fields.push(this.program.element);
    return fields;
  }
}

/** Numbers separated by commas; null where there is none. */
function numbers(text, app) {
  if (text.trim() === "") return null;
  const all = text.split(/[,;\s]+/).filter(Boolean).map(Number);
  if (all.every(Number.isFinite)) return all;
  app.say(`Start: ${text} are no numbers.`);
  return app.scene.start;
}
