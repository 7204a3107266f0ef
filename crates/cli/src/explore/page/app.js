// The page as a whole: the scene, its panes, and what changes it.

import { BranchPane } from "./panes/branches.js";
import { DiagramPane } from "./panes/diagram.js";
import { ParametersPane } from "./panes/parameters.js";
import { BandsPane } from "./panes/bands.js";
import { PortraitPane, ReturnsPane, RunPane } from "./panes/runs.js";
import { SpectrumPane } from "./panes/spectrum.js";
import { VerdictPane } from "./panes/verdict.js";
import { frameOf } from "./frame.js";
import { download } from "./out.js";
import { Questions } from "./questions.js";
import { requests } from "./requests.js";
import { fittedBy, fromAddress, History, parameterOf, rangeOf, sceneOf, toAddress, valuesAt, withAxes, withTold, withValue } from "./scene.js";

/** The panes of one point. */
class PointPanes {
  constructor(app, index) {
    this.verdict = new VerdictPane(app, index);
    this.run = new RunPane(app, index);
    this.portrait = new PortraitPane(app, index);
    this.returns = new ReturnsPane(app, index);
    this.spectrum = new SpectrumPane(app, index);
    this.all = [this.verdict, this.run, this.portrait, this.returns, this.spectrum];
  }
}

export class App {
  constructor(root, engine, begin) {
    Object.assign(this, { root, engine, begin });
    this.systems = begin.systems ?? [];
    this.example = begin.example ?? "";
    this.questions = new Questions(this);
    this.frame = frameOf(this);
    root.append(this.frame.element);
    engine.onChange((slots) => this.busy(slots));
  }

  /** Reads the model and shows the first point. */
  async start() {
    const saved = this.begin.saved ?? null;
    const scene = saved?.state ?? fromAddress(this.begin.address ?? "") ?? null;
    const given = scene?.given ?? this.begin.options ?? {};
    const model = await this.readModel(given);
    if (!model) return;
    this.model = model;
    this.scene = scene && this.fits(scene, model) ? scene : withTold(sceneOf(model, given), model, this.begin.scene);
    this.history = new History(this.scene);
    this.build();
    this.questions.ask({ settled: true, curves: true });
  }

  /** Whether the parameters of a scene are those of the model. */
  fits(scene, model) {
    const names = [scene.axes.x, scene.axes.y, ...Object.keys(scene.values)].filter(Boolean);
    return names.every((name) => parameterOf(model, name)) && scene.points.every((point) => scene.axes.x in point);
  }

  async readModel(given) {
    const answer = await this.engine.ask("model", "model", requests.modelOptions({ given }));
    if (!answer) return null;
    if (answer.error) {
      this.say(answer.error.message, true);
      return null;
    }
    return answer.object;
  }

  build() {
    this.diagram = new DiagramPane(this);
    this.alongs = { x: new BranchPane(this, "x"), y: new BranchPane(this, "y") };
    this.side = new ParametersPane(this);
    this.bands = new BandsPane(this);
    this.points = [0, 1].map((index) => new PointPanes(this, index));
    this.frame.fill(this);
    this.side.rebuild();
    if (!this.engine.answers) this.frame.fix();
    for (const pane of [this.diagram, ...Object.values(this.alongs)]) pane.clear();
    this.show();
  }

  get allPanes() {
    return [this.diagram, this.alongs.x, this.alongs.y, this.bands, ...this.points.flatMap((point) => point.all)];
  }

  /** Lays out what the scene shows. */
  show() {
    const { scene, model } = this;
    this.frame.layout(this);
    this.diagram.element.hidden = !scene.axes.y;
    this.alongs.y.element.hidden = !scene.axes.y;
    this.bands.element.hidden = !scene.fit;
    this.frame.title.textContent = model.title;
    this.side.refresh();
    this.frame.refresh(this);
  }

  // What changes the scene.

  /** Another scene of the same system: shown and computed; it can be undone if it is committed. */
  setScene(scene, { commit = true, curves = true } = {}) {
    this.scene = scene;
    if (commit) {
      this.history.commit(scene);
      this.remember();
    }
    this.show();
    this.questions.ask({ settled: commit, curves });
  }

  change(parts) {
    this.setScene({ ...this.scene, ...parts });
  }

  remember() {
    if (!this.engine.answers || this.begin.inNotebook) return;
    window.history.replaceState(null, "", toAddress(this.scene));
  }

  movePoint(index, at, done) {
    let { scene } = this;
    if (at) {
      const { x, y } = scene.axes;
      const place = { [x]: this.kept(x, at.x), ...(y && { [y]: this.kept(y, at.y) }) };
      const points = scene.points.map((point, i) => (i === index ? { ...point, ...place } : point));
      scene = { ...scene, points, active: index };
    }
    this.questions.moved = performance.now();
    if (done) return this.setScene(scene, { curves: false });
    return this.dragged(scene);
  }

  /** The scene amid a drag: shown in the next frame, and asked as soon as the answer before has come. */
  dragged(scene) {
    this.scene = scene;
    this.nextFrame ??= requestAnimationFrame(() => {
      this.nextFrame = null;
      this.diagram.drawPoints();
      this.side.refresh();
      this.questions.dragged();
    });
  }

  /** A value from a picture: few digits, and positive where it must be. */
  kept(name, value) {
    const one = parameterOf(this.model, name);
    const [lo, hi] = rangeOf(this.scene, this.model, name);
    const digits = one.log ? 5 : Math.max(5, Math.ceil(Math.log10(Math.max(Math.abs(lo), Math.abs(hi)) / (hi - lo))) + 5);
    const kept = Number(value.toPrecision(Math.min(digits, 15)));
    return one.positive && !(kept > 0) ? Math.max(lo, Number.MIN_VALUE) : kept;
  }

  setValue(name, value, done = true) {
    const onAxis = name === this.scene.axes.x || name === this.scene.axes.y;
    const scene = withValue(this.scene, name, value);
    if (done) return this.setScene(scene, { curves: !onAxis });
    this.questions.moved = performance.now();
    return this.dragged(scene);
  }

  setAxis(which, name) {
    const axes = { ...this.scene.axes, [which]: name };
    const other = which === "x" ? "y" : "x";
    if (axes[other] === name) axes[other] = this.scene.axes[which];
    this.setScene(withAxes(this.scene, this.model, axes));
  }

  setRanges(x, y) {
    const ranges = { ...this.scene.ranges };
    const digits = (pair) => pair.map((value) => Number(value.toPrecision(5)));
    for (const [name, pair] of [[this.scene.axes.x, x], [this.scene.axes.y, y]]) {
      if (!pair) delete ranges[name];
      else if (pair[1] > pair[0] && (!parameterOf(this.model, name).positive || pair[1] > 0)) {
        const [lo, hi] = digits(pair);
        ranges[name] = parameterOf(this.model, name).positive && lo <= 0 ? [0, hi] : [lo, hi];
      }
    }
    this.scene = { ...this.scene, ranges };
    this.diagram.compose();
    clearTimeout(this.zoomed);
    this.zoomed = setTimeout(() => this.setScene(this.scene), 350);
  }

  setPortrait(names) {
    this.change({ portrait: names.length >= 2 ? names : null });
    for (const point of this.points) point.portrait.compose();
  }

  setStart(start) {
    this.change({ start });
  }

  setSurface(surface) {
    this.change({ surface });
  }

  /** Shows the law and the parameters of a fit, with the bands that its errors leave; null puts it away. */
  async setFit(text) {
    if (text === null) return this.change({ fit: null });
    const fit = fittedBy(text);
    if (!fit) return this.say("This file is no fit of one state: `twinslip fit RECORD -o fit.json` writes one.");
    const given = { law: fit.law, interfaces: this.model.interfaces ?? 2, si: true };
    const model = await this.readModel(given);
    if (!model) return null;
    // The stiffness of the laboratory is not that of a fault.
    const known = Object.entries(fit.values).filter(([name]) => parameterOf(model, name) && !["driving", "stiffness"].includes(name));
    const begun = sceneOf(model, { ...given, ...(fit.values.reference_rate && { reference_rate: fit.values.reference_rate }) });
    const scene = { ...begun, values: Object.fromEntries(known), fit: `${text.trimEnd()}\n`, theme: this.scene.theme };
    this.setScene(this.changeModel(model, scene));
    return null;
  }

  compare(on) {
    const { scene } = this;
    const point = scene.points[scene.active];
    const points = on ? [point, { ...point }] : [point];
    this.setScene({ ...scene, compare: on, points, active: on ? 1 : 0 }, { curves: false });
  }

  undo(back) {
    const scene = back ? this.history.undo() : this.history.redo();
    if (!scene) return;
    this.restore(scene);
  }

  /** A scene of before, of this system or another one. */
  async restore(scene) {
    const other = JSON.stringify(scene.given) !== JSON.stringify(this.scene.given);
    const model = other ? await this.readModel(scene.given) : this.model;
    if (!model) return;
    if (other) this.changeModel(model, scene);
    this.scene = scene;
    this.remember();
    this.show();
    this.questions.ask({ settled: true, curves: true });
  }

  /** Other options of the model; `anew` forgets the values of the parameters, which are another system's. */
  async setGiven(parts, anew = false) {
    const given = { ...this.scene.given, ...parts };
    for (const [name, value] of Object.entries(given)) if (value === undefined) delete given[name];
    if (anew) {
      if (given.system) delete given.law;
      delete given.set;
      for (const one of this.model.parameters) delete given[one.name];
      if (given.system) for (const name of ["interfaces", "clusters", "si"]) delete given[name];
    }
    const model = await this.readModel(given);
    if (!model) return;
    const { scene } = this;
    const next = { ...scene, given, start: null, portrait: null, surface: null };
    const keeps = !anew && this.fits(next, model);
    this.setScene(this.changeModel(model, keeps ? next : { ...sceneOf(model, given), theme: scene.theme }));
  }

  /** Dimensionless or SI: the same point in other units. */
  async setUnits(si) {
    const names = this.model.parameters.map((one) => one.name);
    const plain = Object.fromEntries(Object.entries(this.scene.given).filter(([name]) => !names.includes(name) && name !== "set"));
    delete plain.si;
    const [from, to] = [await this.readModel({ ...plain, ...(!si && { si: true }) }), await this.readModel({ ...plain, ...(si && { si: true }) })];
    if (!from || !to) return;
    const factor = (name) => {
      const [a, b] = [parameterOf(from, name), parameterOf(to, name)];
      // What is 0 to begin with has its range in both units.
      return a.value && b.value ? b.value / a.value : b.range[1] / a.range[1];
    };
    const converted = (values) => Object.fromEntries(
      Object.entries(values).filter(([name]) => parameterOf(to, name)).map(([name, value]) => [name, Number((value * factor(name)).toPrecision(15))]),
    );
    const { scene } = this;
    const points = scene.points.map(converted);
    this.setScene(this.changeModel(to, {
      ...scene,
      given: { ...plain, ...(si && { si: true }) },
      values: converted(Object.fromEntries(names.map((name) => [name, scene.values[name] ?? scene.given[name]]).filter(([, x]) => typeof x === "number"))),
      ranges: {},
      points,
      start: null,
      until: null,
      surface: null,
      program: "",
    }));
  }

  /** The number that a text with a unit is, by the program. */
  async readValue(name, text) {
    const one = parameterOf(this.model, name);
    const own = one.option ? { [name]: text } : { set: [`${name}=${text}`] };
    const answer = await this.engine.ask("value", "model", { ...requests.modelOptions(this.scene), ...own });
    if (!answer || answer.error || Boolean(answer.object.si) !== Boolean(this.model.si)) return null;
    return parameterOf(answer.object, name)?.value ?? null;
  }

  /** Another system, or the same in other units: nothing of the one before is shown. */
  changeModel(model, scene) {
    Object.assign(this, { model, scene });
    this.engine.stopWhere((slot) => slot !== "model");
    this.side.rebuild();
    for (const pane of this.allPanes) pane.clear();
    this.questions.forget();
    return scene;
  }

  // What is said and kept.

  busy(slots) {
    this.frame.busy(slots);
    if (!this.points) return;
    this.diagram.busy(slots, [...this.model.loci.map((kind) => `locus:${kind}`), "map"]);
    for (const which of ["x", "y"]) this.alongs[which].busy(slots, [`branch:${which}:equilibria`, `branch:${which}:orbits`]);
    this.bands.busy(slots, ["bands"]);
    this.points.forEach((point, i) => {
      point.run.busy(slots, [`run:${i}`]);
      point.portrait.busy(slots, [`run:${i}`]);
      point.returns.busy(slots, [`section:${i}`]);
      point.spectrum.busy(slots, [`equilibria:${i}`, `orbit:${i}`]);
      point.verdict.busy(slots, [`equilibria:${i}`, `orbit:${i}`, `section:${i}`]);
    });
  }

  say(text, stays = false) {
    this.frame.say(text, stays);
  }

  showText(title, text) {
    this.frame.showText(title, text);
  }

  save(name, text, type) {
    download(name, text, type);
  }

  /** The names of options that make a system in Python. */
  systemNames() {
    const own = this.model.parameters.filter((one) => one.option).map((one) => one.name);
    return [...own, ...this.model.options];
  }

  /** The page as it stands, as one file that needs no server. */
  async savePage() {
    const content = { recording: this.engine.recording(), state: this.scene };
    const saved = await this.engine.transport.save?.(content);
    if (saved) download("twinslip.html", saved, "text/html");
    else this.say("The page could not be saved.");
  }

  /** The values at a point, for those who read them from outside. */
  values(index = this.scene.active) {
    return valuesAt(this.scene, this.model, index);
  }
}
