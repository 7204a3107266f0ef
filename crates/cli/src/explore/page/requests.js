// The commands behind the panes: for each, its name and options at a point of a scene.

import { changesOf } from "./panes/program.js";
import { fittedBy, parameterOf, rangeOf, valuesAt } from "./scene.js";

/** The options that `api/model` is asked with. */
function modelOptions(scene) {
  const options = {};
  for (const [name, value] of Object.entries(scene.given)) options[name.replaceAll("-", "_")] = value;
  return options;
}

/** The options of the system at a point, without the parameters named. */
function systemOptions(scene, model, index, without = []) {
  const options = {};
  for (const name of model.options) if (scene.given[name] !== undefined) options[name] = scene.given[name];
  const given = scene.given.set === undefined ? [] : [scene.given.set].flat();
  const set = [];
  const values = valuesAt(scene, model, index);
  for (const one of model.parameters) {
    if (without.includes(one.name)) continue;
    const told = one.name in scene.values || one.name in scene.points[index];
    const begun = scene.given[one.name] !== undefined || given.some((text) => text.split("=")[0].trim() === one.name);
    if (!told && !begun) continue;
    if (one.option) options[one.name] = values[one.name];
    else set.push(`${one.name}=${values[one.name]}`);
  }
  for (const text of given) {
    const name = text.split("=")[0].trim();
    if (!parameterOf(model, name) && !without.includes(name)) set.push(text);
  }
  if (set.length) options.set = set;
  return options;
}

/** Of a parameter that must be positive, a range from 0 begins at this part of its end. */
const LEAST = 0.02;

/** The range of an axis as `NAME=A:B`, inside the domain of the parameter. */
function interval(scene, model, name) {
  const [lo, hi] = rangeOf(scene, model, name);
  return `${name}=${lo <= 0 && parameterOf(model, name)?.positive ? Number((LEAST * hi).toPrecision(3)) : lo}:${hi}`;
}

const listed = (numbers) => numbers.map(String).join(",");

/** All equilibria at the point. */
function equilibria(scene, model, index, box = null) {
  const options = systemOptions(scene, model, index);
  if (model.kind === "system" && box) options.box = box;
  return { command: "equilibria", options };
}

/** The orbit that runs settle on. */
function orbit(scene, model, index) {
  const options = { ...systemOptions(scene, model, index), crosscheck: "none" };
  if (model.symmetries.length && scene.symmetry !== "both") options.symmetry = scene.symmetry;
  if (scene.start) options.start = listed(scene.start);
  return { command: "orbit", options };
}

/** Steps of a run, at least. */
const STEPS = 600;

/** A run in time, with its picture where that is wanted. */
function run(scene, model, index, until, plot = true) {
  const options = { ...systemOptions(scene, model, index), until };
  if (plot) options.plot = true;
  // Portraits join the rows: of steps that are long for their accuracy they would be polygons.
  if (model.kind === "system") options.max_step = Number((until / STEPS).toPrecision(3));
  if (scene.start) options.start = listed(scene.start);
  if (scene.program && model.kind === "interfaces") options.program = scene.program;
  return { command: "integrate", options };
}

/** The return map, with Lyapunov exponents where asked. */
function section(scene, model, index, { returns, skip, lyapunov, patience }) {
  const options = { ...systemOptions(scene, model, index), returns, skip, plot: true };
  if (patience) options.patience = patience;
  if (lyapunov) options.lyapunov = true;
  const surface = scene.surface ?? model.surface;
  if (surface) options.surface = surface;
  if (scene.start) options.start = listed(scene.start);
  return { command: "section", options };
}

/** Branches through the point along a parameter, over the range of its axis. */
function branch(scene, model, index, of, along) {
  const options = { ...systemOptions(scene, model, index, [along]), of, along: interval(scene, model, along) };
  if (model.symmetries.length && scene.symmetry !== "both") options.symmetry = scene.symmetry;
  return { command: "branch", options };
}

/** A curve of bifurcations in the plane of the axes. */
function locus(scene, model, kind) {
  const { x, y } = scene.axes;
  const options = { ...systemOptions(scene, model, scene.active, [x, y]), of: kind, in: `${interval(scene, model, x)},${interval(scene, model, y)}` };
  if (model.symmetries.length && scene.symmetry !== "both") options.symmetry = scene.symmetry;
  return { command: "locus", options };
}

/** A map of regimes over the plane, so many cells wide and high; of a fit the probabilities of regimes. */
function regimes(scene, model, cells) {
  const { x, y } = scene.axes;
  const grid = (name) => {
    const log = parameterOf(model, name)?.log ? "log" : "";
    return `${interval(scene, model, name)}:${cells}${log}`;
  };
  const options = { ...systemOptions(scene, model, scene.active, [x, y]), grid: y ? [grid(x), grid(y)] : [grid(x)], plot: true };
  const surface = scene.surface ?? model.surface;
  if (surface && model.kind === "system") options.surface = surface;
  if (scene.fit) return { command: "sweep", options: withFit(scene, options) };
  return { command: "sweep", options };
}

/** Equilibria with the bands that a fit leaves. */
function bands(scene, model, index) {
  return { command: "equilibria", options: { ...withFit(scene, systemOptions(scene, model, index)), plot: true } };
}

/** The steady-state friction of one interface. */
function law(scene, model, index) {
  const options = { ...systemOptions(scene, model, index, ["driving", "stiffness"]), plot: true };
  return { command: "law", options };
}

/** The same options with the law and the parameters of the fit, and their errors: its text, and how many draws. */
function withFit(scene, options) {
  const { values } = fittedBy(scene.fit);
  const all = Object.entries(options).filter(([name]) => !(name in values) && name !== "law" && name !== "si");
  return { ...Object.fromEntries(all), ensemble: `${scene.fit.trimEnd()}\n:${scene.draws}` };
}

/**
 * How long a run is shown: some periods of the orbit, else some times of the slowest that grows or decays, else of the fastest that turns;
 * null where nothing tells.
 */
function untilOf(scene, model, equilibriaAnswer, orbitAnswer) {
  if (scene.until) return scene.until;
  // All changes of a program are shown, and what follows the last.
  const changed = 1.2 * Math.max(0, ...(changesOf(scene.program) ?? []).map(({ to }) => to));
  const until = Math.max(changed, durationOf(model, equilibriaAnswer, orbitAnswer));
  return until > 0 ? rounded(until, changed > 0) : null;
}

function durationOf(model, equilibriaAnswer, orbitAnswer) {
  const period = orbitAnswer?.result?.orbit?.period;
  const turns = typeof period === "number" ? period : period?.value;
  if (turns > 0) return 8 * turns;
  const first = (equilibriaAnswer?.result?.equilibria?.[0]?.eigenvalues ?? []).map((one) => one.value ?? one);
  const imaginary = Math.max(0, ...first.map(([, im]) => Math.abs(im)));
  const real = first.map(([re]) => Math.abs(re)).filter((re) => re > 0);
  const slow = real.length ? 8 / Math.min(...real) : 0;
  const turning = imaginary > 0 ? (12 * 2 * Math.PI) / imaginary : 0;
  if (slow && turning) return Math.min(Math.max(slow, turning), 10 * turning);
  return slow || turning || model.duration || 0;
}

/** All of them. */
export const requests = { modelOptions, systemOptions, equilibria, orbit, run, section, branch, locus, regimes, bands, law, withFit, untilOf };

/** Two digits are enough for a time that is only shown; `up` rounds to more. */
function rounded(x, up = false) {
  const unit = 10 ** (Math.floor(Math.log10(x)) - 1);
  return up ? Number((Math.ceil(x / unit) * unit).toPrecision(2)) : Number(x.toPrecision(2));
}
