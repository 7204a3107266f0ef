// What happens at a point, in words: equilibria, the orbit, what runs settle on, and where a verdict is undecided, why.

import { element } from "../elements.js";
import { bounded, Pane, short } from "./pane.js";
import { parameterOf, valuesAt } from "../scene.js";
import { explained, term } from "../glossary.js";

const COUNT = ["No", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine"];

const several = (n, one, many = `${one}s`) => `${COUNT[n] ?? n} ${n === 1 ? one : many}`;

/** Words about the equilibria. */
function ofEquilibria(answer, kind) {
  if (!answer) return null;
  if (answer.error) return answer.error.message;
  const all = answer.result?.equilibria ?? [];
  const steady = kind === "interfaces" ? "steady state" : "equilibrium";
  const many = kind === "interfaces" ? "steady states" : "equilibria";
  if (!all.length) return `No ${steady} found.`;
  const each = all.map((state) => {
    const name = state.symmetry ? `the ${state.symmetry} one` : all.length > 1 ? "one" : "it";
    if (!state.verdict) return name;
    const growing = state.verdict === "unstable" && state.unstable ? ` (${state.unstable} growing)` : "";
    return `${name} is ${state.verdict}${growing}`;
  });
  const more = answer.result?.complete === false ? " There may be others." : "";
  return `${several(all.length, steady, many)}: ${each.join(", ")}.${more}`;
}

/** Words about the orbit that was found. */
function ofOrbit(answer, unit) {
  if (!answer) return null;
  if (answer.error) return answer.error.kind === "numerical" ? `No periodic orbit: ${answer.error.message}.` : answer.error.message;
  const orbit = answer.result?.orbit;
  if (!orbit) return null;
  const period = bounded(orbit.period?.value ?? orbit.period, orbit.period?.uncertainty);
  const symmetry = orbit.symmetry ? `${orbit.symmetry} ` : "";
  const others = answer.result.others?.length ?? 0;
  const more = others ? ` ${several(others, "other orbit is", "other orbits are")} known.` : "";
  const article = /^[aeiou]/.test(symmetry || "periodic") ? "An" : "A";
  return `${article} ${symmetry}periodic orbit of period ${period}${unit ? ` ${unit}` : ""} is ${orbit.verdict}.${more}`;
}

/** Words about the long-time behaviour. */
function ofSection(answer) {
  if (!answer) return null;
  if (answer.error) return answer.error.kind === "numerical" ? `The return map: ${answer.error.message}.` : null;
  const result = answer.result;
  if (!result) return null;
  const first = result.lyapunov?.[0];
  const exponent = first ? ` The largest Lyapunov exponent is ${bounded(first.value, first.uncertainty)}` : "";
  switch (result.regime) {
    case "chaotic":
      return `${exponent.trim()}, above zero beyond its bound: close runs part exponentially, and the returns repeat in no pattern. This is chaos.`;
    case "torus": {
      const turns = result.rotation_number ? ` of rotation number ${bounded(result.rotation_number.value ?? result.rotation_number, result.rotation_number.uncertainty)}` : "";
      return `The returns lie on closed curves: a torus${turns}.${exponent && `${exponent}.`}`;
    }
    case "periodic": {
      const q = result.period_of_orbit;
      const times = q > 1 ? ` after ${q} returns` : "";
      return `Runs from here settle on a motion that repeats${times}.`;
    }
    case "steady":
      return "Runs from here come to rest at a steady state.";
    default:
      return `Undecided what runs settle on${result.note ? `: ${result.note}` : ""}.${exponent && `${exponent}.`}`;
  }
}

/** The verdict in one or two words, and its tone. */
function headline({ equilibria, orbit, section }) {
  const regime = section?.result?.regime;
  if (regime) return regime;
  // Where there is no return map, or not yet.
  const found = orbit?.result?.orbit;
  if (found?.verdict === "stable") return "periodic";
  const stable = (equilibria?.result?.equilibria ?? []).some((one) => one.verdict === "stable");
  return stable && !found ? "steady" : "not yet known";
}

export class VerdictPane extends Pane {
  constructor(app, index) {
    super(app, { title: "What happens here", name: "verdict", drawn: false });
    this.index = index;
    this.answers = {};
    this.big = element("p", { class: "headline", "aria-live": "polite" });
    this.place = element("p", { class: "place" });
    this.list = element("ul", {});
    this.body.append(this.place, this.big, this.list);
  }

  /** Another point: what was said is of the one before until answers come. */
  moved() {
    this.answers = {};
    const { scene, model } = this.app;
    const values = valuesAt(scene, model, this.index);
    const at = [scene.axes.x, scene.axes.y].filter(Boolean).map((name) => {
      const one = parameterOf(model, name);
      return `${one?.symbol ?? name} = ${short(values[name])}${one?.unit ? ` ${one.unit}` : ""}`;
    });
    this.place.textContent = at.join(", ");
  }

  takeAnswer(what, answer) {
    this.answers[what] = answer;
    if (what === (this.app.model.rests ? "equilibria" : "orbit")) this.take(answer);
    this.answer = this.answers.section ?? this.answers.orbit ?? this.answers.equilibria ?? answer;
    this.write();
  }

  write() {
    const { model } = this.app;
    const word = headline(this.answers);
    this.big.replaceChildren(term(word));
    this.big.dataset.regime = word;
    const unit = this.answers.orbit?.object?.units?.time;
    const sentences = [
      ofEquilibria(this.answers.equilibria, model.kind),
      ofOrbit(this.answers.orbit, unit),
      ofSection(this.answers.section),
      ...this.undecided(),
    ];
    this.list.replaceChildren(...sentences.filter(Boolean).map((text) => element("li", {}, text)));
    this.problem.hidden = true;
  }

  /** Why something is undecided, as the commands say. */
  undecided() {
    const told = Object.values(this.answers).flatMap((answer) => answer?.says ?? []);
    const why = told.filter((text) => text.startsWith("undecided: ")).map((text) => `Undecided: ${text.slice(11)}`);
    return [...new Set(why)];
  }

  svg() {
    return null;
  }

  exports() {
    const withoutPictures = super.exports().filter(([label]) => !label.startsWith("Picture"));
    return withoutPictures.map(([label, act]) => (label.startsWith("Numbers") ? ["Numbers (JSON)", () => this.saveJson()] : [label, act]));
  }

  saveJson() {
    const objects = Object.fromEntries(Object.entries(this.answers).map(([what, answer]) => [what, answer?.object ?? null]));
    this.app.save("verdict.json", JSON.stringify(objects, null, 1), "application/json");
  }
}

/** What a regime means, for those who point at it. */
export function regimeWords(regime) {
  return explained(regime);
}
