// What is asked when the scene changes: what takes least at once, the others when the point rests.

import { rangeAround } from "./panes/panels.js";
import { requests } from "./requests.js";

/** After so many milliseconds without a move, what takes longer is asked too. */
const SETTLED = 180;
/** An answer amid a drag that takes longer is given up for a newer one. */
const OVERDUE = 400;
/** The run does not wait longer for the period of the orbit. */
const PATIENCE = 20;
/** Returns of the map, and those before. */
const RETURNS = { returns: 600, skip: 400 };
/** Cells of a map of regimes along each axis; of a fit, whose map is one for each draw. */
const CELLS = { one: 24, fit: 10 };
/** Curves that take least come first. */
const QUICK = ["pitchfork", "saddle-node", "hopf", "period-doubling", "orbit-pitchfork", "torus", "orbit-saddle-node", "homoclinic"];

/** Curves of orbits of these models take minutes: they are computed when somebody asks for them. */
function isCostly(model) {
  const unequal = model.parameters.some(({ name }) => /_\d+$/.test(name));
  const builtIn = !/\.toml$|\n/.test(model.law ?? "");
  return model.kind === "interfaces" && (model.states.length > 3 || unequal || !builtIn);
}

const OF_ORBITS = /^(orbit-|period-doubling|torus|homoclinic)/;

/** Notes how long something took, for the clock of the browser. */
function timed(name, began) {
  performance.measure(`twinslip ${name}`, { start: began, end: performance.now() });
}

export class Questions {
  constructor(app) {
    this.app = app;
    /** When the point moved last, and when that was asked. */
    this.moved = null;
    this.asked = null;
    this.boxes = {};
    this.hasCurves = false;
    this.mapOf = null;
  }

  /** Another system: its curves are not there. */
  forget() {
    this.hasCurves = false;
    this.mapOf = null;
  }

  /** The point has moved amid a drag. */
  dragged() {
    const now = performance.now();
    // Answers that were stopped by each new position would never come.
    if (this.asked && now - this.asked < OVERDUE) {
      this.again = true;
      return;
    }
    this.asked = now;
    this.again = false;
    this.ask({ settled: false, curves: false });
  }

  /** The scene has changed: quick answers at once, the others when it has settled. */
  ask({ settled, curves }) {
    const { scene, engine } = this.app;
    const shown = scene.compare ? [0, 1] : [0];
    for (const index of shown) this.askPoint(index, !settled);
    clearTimeout(this.settling);
    // A drag that goes on leaves nothing behind that takes the processor.
    if (!settled) engine.stopWhere((slot) => /^(section|branch)/.test(slot));
    this.settling = setTimeout(() => {
      if (!settled) for (const index of shown) this.askPoint(index, false);
      this.settle(shown, curves);
    }, settled ? 0 : SETTLED);
  }

  settle(shown, curves) {
    const { scene, bands } = this.app;
    this.asked = null;
    for (const index of shown) this.askSection(index);
    for (const which of ["x", "y"]) if (scene.axes[which]) this.askBranch(which);
    if (scene.fit) bands.ask();
    if (curves || !this.hasCurves) this.askCurves();
  }

  /** Equilibria, the orbit and a run at a point; amid a drag the run has no picture, and no orbit is looked for. */
  askPoint(index, dragged) {
    const { scene, model, engine, points, side } = this.app;
    const panes = points[index];
    const began = dragged ? this.moved : null;
    const ticket = (panes.ticket = (panes.ticket ?? 0) + 1);
    let drawn = 0;
    // Both are there: the drag is answered.
    const answered = () => {
      drawn += 1;
      if (drawn !== 2 || !began) return;
      requestAnimationFrame(() => timed("drag", began));
      this.asked = null;
      if (this.again) this.dragged();
    };
    panes.verdict.moved();
    // Under a periodic forcing nothing rests.
    const known = { equilibria: model.rests ? null : {}, orbit: null };
    let until = null;
    const run = () => {
      const kept = dragged && !known.orbit?.ended && !scene.until ? panes.until : null;
      const next = kept ?? requests.untilOf(scene, model, known.equilibria, known.orbit);
      if (!next) {
        panes.run.ask();
        return;
      }
      if (until && Math.abs(Math.log(next / until)) < 0.3) return;
      until = next;
      this.app.untilShown = until;
      panes.until = until;
      side.refresh();
      const { command, options } = requests.run(scene, model, index, until, !dragged);
      engine.ask(`run:${index}`, command, options, {
        onUpdate: (answer) => {
          if (answer.ended || answer.error) {
            panes.run.takeRun(answer);
            panes.portrait.takeRun(answer);
            answered();
            if (answer.ended && model.kind === "system" && model.rests) this.askAround(index, answer);
          }
        },
      });
    };
    const orbit = requests.orbit(scene, model, index);
    if (dragged) engine.stop(`orbit:${index}`);
    else engine.ask(`orbit:${index}`, orbit.command, orbit.options, {
      onUpdate: (answer) => {
        if (!answer.ended && !answer.error) return;
        known.orbit = answer;
        panes.spectrum.takeOrbit(answer);
        panes.verdict.takeAnswer("orbit", answer);
        if (!scene.until && panes.ticket === ticket && (known.equilibria || answer.ended)) run();
      },
    });
    const waits = () => {
      if (known.orbit) return run();
      setTimeout(() => {
        if (panes.ticket === ticket && !until) run();
      }, PATIENCE);
    };
    if (!model.rests) {
      for (const pane of [panes.spectrum, panes.portrait]) pane.takeEquilibria(null);
      answered();
      if (scene.until || (dragged && panes.until)) run();
      else waits();
      return;
    }
    // What takes least is asked last, and begun first.
    const wanted = requests.equilibria(scene, model, index, this.boxes[index]?.of === model ? this.boxes[index].box : null);
    engine.ask(`equilibria:${index}`, wanted.command, wanted.options, {
      onUpdate: (answer) => {
        if (!answer.ended && !answer.error) return;
        known.equilibria = answer;
        for (const pane of [panes.spectrum, panes.portrait]) pane.takeEquilibria(answer);
        panes.verdict.takeAnswer("equilibria", answer);
        answered();
        if (!scene.until) waits();
      },
    });
    // Amid a drag the run goes as far as the one before, until more is known.
    if (scene.until || (dragged && panes.until)) run();
  }

  /** All equilibria in a box around the run, for systems whose equilibria are found near a start alone. */
  askAround(index, answer) {
    const { scene, model, engine, points } = this.app;
    const sides = model.states.map(({ name }) => {
      const list = answer.column(name);
      if (!list) return null;
      const [lo, hi] = rangeAround([list]);
      const width = hi - lo;
      // Digits that the width has, however far from 0 the box is.
      const unit = 10 ** (Math.floor(Math.log10(width)) - 1);
      const digits = (x) => Number((x * unit).toPrecision(12));
      return `${name}=${digits(Math.floor((lo - width / 2) / unit))}:${digits(Math.ceil((hi + width / 2) / unit))}`;
    });
    if (sides.some((side) => side === null) || sides.length > 6) return;
    const box = sides.join(",");
    if (this.boxes[index]?.box === box && this.boxes[index].of === model) return;
    this.boxes[index] = { box, of: model };
    const { command, options } = requests.equilibria(scene, model, index, box);
    const panes = points[index];
    engine.ask(`equilibria:${index}`, command, options, {
      onUpdate: (all) => {
        if (!all.ended) return;
        for (const pane of [panes.spectrum, panes.portrait]) pane.takeEquilibria(all);
        panes.verdict.takeAnswer("equilibria", all);
      },
    });
  }

  askSection(index) {
    const { scene, model, engine, points } = this.app;
    if (model.states.length < 2) return;
    const { command, options } = requests.section(scene, model, index, { ...RETURNS, lyapunov: true });
    const panes = points[index];
    engine.ask(`section:${index}`, command, options, {
      background: true,
      first: true,
      onUpdate: (answer) => {
        panes.returns.takeSection(answer);
        if (answer.ended || answer.error) panes.verdict.takeAnswer("section", answer);
      },
    });
  }

  askBranch(which) {
    const { scene, model, engine, alongs } = this.app;
    const along = scene.axes[which];
    for (const of of model.rests ? ["equilibria", "orbits"] : ["orbits"]) {
      const { command, options } = requests.branch(scene, model, scene.active, of, along);
      engine.ask(`branch:${which}:${of}`, command, options, {
        background: true,
        onUpdate: (answer) => alongs[which].takeBranch(of, answer),
      });
    }
  }

  /** The curves of the diagram, those that take least first. */
  askCurves() {
    const { scene, model, engine, diagram } = this.app;
    this.hasCurves = true;
    if (!scene.axes.y) return;
    if (this.mapOf && this.mapOf !== this.inPlane()) {
      engine.stop("map");
      diagram.forgetMap();
    }
    const all = [...model.loci].sort((a, b) => QUICK.indexOf(a) - QUICK.indexOf(b));
    const waits = isCostly({ ...model, law: scene.given.law }) && !scene.orbits;
    const kinds = waits ? all.filter((kind) => !OF_ORBITS.test(kind)) : all;
    diagram.offerOrbits(waits);
    const began = performance.now();
    const asked = kinds.map((kind) => {
      const { command, options } = requests.locus(scene, model, kind);
      return engine.ask(`locus:${kind}`, command, options, {
        background: true,
        onUpdate: (answer) => diagram.takeCurve(kind, answer),
      });
    });
    Promise.all(asked).then((answers) => {
      if (answers.every((answer) => answer)) timed("curves", began);
    });
  }

  /** What a map of regimes is of: all but where the point is. */
  inPlane() {
    const { scene, model } = this.app;
    return JSON.stringify([requests.systemOptions(scene, model, scene.active, [scene.axes.x, scene.axes.y]), scene.axes, scene.fit]);
  }

  askMap() {
    const { scene, model, engine, diagram } = this.app;
    const { command, options } = requests.regimes(scene, model, scene.fit ? CELLS.fit : CELLS.one);
    this.mapOf = this.inPlane();
    engine.ask("map", command, options, { background: true, first: true, onUpdate: (answer) => diagram.takeMap(answer) });
  }
}
