// What is looked at: the system, the values of its parameters, the points, and how it is shown; with undo, and as an address.

/** Everything that the page shows follows from this and the answers of the solver; plain data. */
export function sceneOf(model, given = {}) {
  const [x, y = null] = model.axes;
  const value = (name) => model.parameters.find((one) => one.name === name)?.value ?? 0;
  return {
    given,
    values: {},
    axes: { x, y },
    ranges: {},
    points: [{ [x]: value(x), ...(y && { [y]: value(y) }) }],
    active: 0,
    start: null,
    until: null,
    symmetry: "both",
    program: "",
    fit: null,
    draws: 20,
    portrait: null,
    surface: null,
    compare: false,
    orbits: false,
    theme: "auto",
  };
}

/** The first scene with what a scene file says beside the model: its start, end, program, and the ranges that it names. */
export function withTold(scene, model, told) {
  if (!told) return scene;
  const next = { ...scene, ranges: { ...scene.ranges } };
  const { options } = told;
  if (Number(options.until) > 0) next.until = Number(options.until);
  if (typeof options.program === "string" && !options.program.includes("\n")) next.program = options.program;
  if (["symmetric", "asymmetric"].includes(options.symmetry)) next.symmetry = options.symmetry;
  if (typeof options.surface === "string") next.surface = options.surface;
  const start = String(options.start ?? "").split(",").map(Number);
  if (start.length === model.states.length && start.every(Number.isFinite)) next.start = start;
  const ranges = [options.along, options.in, options.grid, options.range].flat().filter((text) => typeof text === "string");
  const named = ranges.flatMap((text) => text.split(/,(?=[^,:]*=)/)).map((text) => /^([^=]+)=([^:,]+)[:,]([^:,]+)/.exec(text));
  for (const found of named.filter(Boolean)) take(next, model, found[1].trim(), found[2], found[3]);
  for (const name of ["driving", "stiffness"]) {
    const [from, to] = String(options[`${name}_range`] ?? "").split(/[,:]/);
    take(next, model, name, from, to);
  }
  return next;
}

function take(scene, model, name, from, to) {
  const pair = [Number(from), Number(to)].sort((a, b) => a - b);
  if (to !== undefined && parameterOf(model, name) && pair.every(Number.isFinite) && pair[0] < pair[1]) scene.ranges[name] = pair;
}

/** The values of all parameters at a point, by name. */
export function valuesAt(scene, model, index) {
  const all = Object.fromEntries(model.parameters.map((one) => [one.name, one.value]));
  return { ...all, ...scene.values, ...scene.points[index] };
}

/** The parameter of this name. */
export function parameterOf(model, name) {
  return model.parameters.find((one) => one.name === name) ?? null;
}

/** The range of a parameter on an axis or slider. */
export function rangeOf(scene, model, name) {
  const [lo, hi] = scene.ranges[name] ?? parameterOf(model, name)?.range ?? [0, 1];
  return lo < hi ? [lo, hi] : [hi, lo];
}

/** The same scene with another value of a parameter, at the active point if it is on an axis. */
export function withValue(scene, name, value) {
  if (name !== scene.axes.x && name !== scene.axes.y) return { ...scene, values: { ...scene.values, [name]: value } };
  const points = scene.points.map((point, i) => (i === scene.active ? { ...point, [name]: value } : point));
  return { ...scene, points };
}

/** The same scene with other parameters on the axes: the points keep their values of both. */
export function withAxes(scene, model, axes) {
  const values = { ...scene.values };
  const points = scene.points.map((point, i) => {
    const all = valuesAt(scene, model, i);
    const names = [axes.x, axes.y].filter(Boolean);
    return Object.fromEntries(names.map((name) => [name, all[name]]));
  });
  // What leaves an axis stays as it is at the active point.
  for (const name of [scene.axes.x, scene.axes.y]) {
    if (name && name !== axes.x && name !== axes.y) values[name] = scene.points[scene.active][name];
  }
  for (const name of [axes.x, axes.y]) delete values[name];
  return { ...scene, axes, values, points };
}

/** What can be undone. */
export class History {
  constructor(scene) {
    this.past = [];
    this.future = [];
    this.now = scene;
  }

  /** A new scene; what was undone can't be done again. */
  commit(scene) {
    if (JSON.stringify(scene) === JSON.stringify(this.now)) return;
    this.past.push(this.now);
    if (this.past.length > 200) this.past.shift();
    this.future = [];
    this.now = scene;
  }

  undo() {
    if (!this.past.length) return null;
    this.future.push(this.now);
    this.now = this.past.pop();
    return this.now;
  }

  redo() {
    if (!this.future.length) return null;
    this.past.push(this.now);
    this.now = this.future.pop();
    return this.now;
  }
}

/** The law of a fit and all its values, fitted and fixed; null for a text that is no fit. */
export function fittedBy(text) {
  let fit = null;
  try {
    fit = JSON.parse(text).result.fit;
  } catch {
    return null;
  }
  if (!fit || !isText(fit.law) || !Array.isArray(fit.parameters) || fit.states > 1) return null;
  const fitted = fit.parameters.map(({ name, value }) => [name, value]);
  return { law: fit.law, values: numbersOf(Object.fromEntries([...Object.entries(fit.fixed ?? {}), ...fitted])) };
}

/** The scene as the part of an address behind #. */
export function toAddress(scene) {
  return `#scene=${encodeURIComponent(JSON.stringify(scene))}`;
}

const isNumber = (value) => typeof value === "number" && Number.isFinite(value);
const isText = (value) => typeof value === "string" && value.length < 200000;
const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);
const numbersOf = (value) => Object.fromEntries(Object.entries(isObject(value) ? value : {}).filter(([, x]) => isNumber(x)));

/**
 * The scene of an address, or null where it has none. What comes by an address is anybody's: only what has the form of a scene is taken.
 */
export function fromAddress(hash) {
  const text = /^#scene=(.*)$/s.exec(hash ?? "")?.[1];
  if (!text) return null;
  let told;
  try {
    told = JSON.parse(decodeURIComponent(text));
  } catch {
    return null;
  }
  if (!isObject(told) || !isObject(told.axes) || !isText(told.axes.x) || !Array.isArray(told.points)) return null;
  const plain = (value) => isNumber(value) || isText(value) || value === true || (Array.isArray(value) && value.every(isText));
  const given = Object.fromEntries(Object.entries(isObject(told.given) ? told.given : {}).filter(([, value]) => plain(value)));
  const range = (pair) => Array.isArray(pair) && pair.length === 2 && pair.every(isNumber);
  const points = told.points.slice(0, 2).map(numbersOf);
  if (!points.length) return null;
  return {
    given,
    values: numbersOf(told.values),
    axes: { x: told.axes.x, y: isText(told.axes.y) ? told.axes.y : null },
    ranges: Object.fromEntries(Object.entries(isObject(told.ranges) ? told.ranges : {}).filter(([, pair]) => range(pair))),
    points,
    active: told.active === 1 && points.length > 1 ? 1 : 0,
    start: Array.isArray(told.start) && told.start.every(isNumber) ? told.start : null,
    until: isNumber(told.until) && told.until > 0 ? told.until : null,
    symmetry: ["both", "symmetric", "asymmetric"].includes(told.symmetry) ? told.symmetry : "both",
    program: isText(told.program) ? told.program : "",
    fit: isText(told.fit) ? told.fit : null,
    draws: isNumber(told.draws) ? Math.min(Math.max(Math.round(told.draws), 0), 1000) : 20,
    portrait: Array.isArray(told.portrait) && told.portrait.slice(0, 3).every(isText) ? told.portrait.slice(0, 3) : null,
    surface: isText(told.surface) ? told.surface : null,
    orbits: told.orbits === true,
    compare: told.compare === true && points.length > 1,
    theme: ["auto", "light", "dark"].includes(told.theme) ? told.theme : "auto",
  };
}
