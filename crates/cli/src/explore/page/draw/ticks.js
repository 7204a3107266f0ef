/** Scales of axes, and where an axis has ticks and what they say: as many as have room. */

/** At most so many ticks. */
const TICKS = 7;
/** Logarithmic axes shorter than this many decades have ticks at 2 and 5 too. */
const FEW_DECADES = 2.6;
/** And those shorter than this at every digit. */
const SHORT = 0.8;
/** Even those leave axes shorter than this with a number or none: they have ticks at equal differences. */
const SHORTEST = 0.3;
/** Where a decade has fewer pixels than this, a small tick is at each power of ten only. */
const DECADE = 45;

/**
 * An axis in the coordinate that is drawn: the value, or its decimal logarithm.
 *
 * @typedef {{lo: number, hi: number, log: boolean}} Scale
 */

/**
 * Returns the scale of an axis of a description.
 *
 * @param {{log: boolean, range: [number, number]}} axis
 * @param {[number, number]} [range] in place of that of the axis
 * @returns {Scale}
 */
export function scaleOf(axis, range) {
  const log = Boolean(axis.log);
  const ends = (pair) => (pair ?? []).map((end) => (log ? Math.log10(end) : Number(end)));
  const usable = (pair) => pair.length === 2 && pair.every(Number.isFinite) && pair[0] !== pair[1];
  const found = [ends(range), ends(axis.range)].find(usable) ?? [0, 1];
  return { lo: Math.min(...found), hi: Math.max(...found), log };
}

/** Returns the coordinate of a value on a scale; not finite if it cannot be drawn. */
export function coordinateOf(scale, value) {
  return scale.log ? Math.log10(value) : value;
}

/** Returns the value at a coordinate. */
export function valueAt(scale, coordinate) {
  return scale.log ? 10 ** coordinate : coordinate;
}

/**
 * Returns the most ticks that fit on an axis.
 *
 * @param {Scale} scale
 * @param {number} pixels its length
 * @param {(ticks: {at: number, label: string}[]) => boolean} fits judges whether labels have room
 * @returns {{named: {at: number, label: string}[], small: number[]}} coordinates, with labels and without
 */
export function ticksOf(scale, pixels, fits) {
  const choices = tickChoices(scale);
  // One number says nothing of an axis, if two can be had.
  const chosen =
    choices.find((ticks) => ticks.length >= 2 && fits(ticks)) ??
    choices.find((ticks) => ticks.length >= 1 && fits(ticks));
  const named = chosen ?? choices.findLast((ticks) => ticks.length >= 1)?.slice(0, 1) ?? [];
  return { named, small: smallTicks(scale, pixels, named) };
}

/** Sets of ticks, the densest first. */
function tickChoices(scale) {
  const length = scale.hi - scale.lo;
  const count = (most) => Array.from({ length: most }, (_, i) => most - i);
  if (!scale.log) {
    return count(TICKS).map((n) => evenTicks(scale.lo, scale.hi, niceStep(length / n), (x) => x));
  }
  if (length >= FEW_DECADES) {
    const steps = [1, 2, 3, 5, 10, 20, 50, 100, 200].filter((step) => length / step <= TICKS);
    return steps.map((step) => decadeTicks(scale, step));
  }
  const choices = [];
  const digits = [[1, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 5], [1, 3], [1]];
  if (length >= SHORTEST) {
    const allowed = length < SHORT ? digits : digits.slice(1);
    choices.push(...allowed.map((some) => digitTicks(scale, some)));
  }
  const [lo, hi] = [10 ** scale.lo, 10 ** scale.hi];
  choices.push(...count(TICKS - 2).map((n) => evenTicks(lo, hi, niceStep((hi - lo) / n), Math.log10)));
  return choices;
}

/** Ticks at the multiples of a step. */
function evenTicks(lo, hi, step, place) {
  const largest = Math.max(Math.abs(lo), Math.abs(hi));
  const first = Math.ceil(lo / step - 1e-9);
  const ticks = [];
  for (let i = 0; i <= 2 * TICKS; i++) {
    const x = (first + i) * step;
    if (x <= hi + 1e-9 * step) ticks.push({ at: place(x), label: plainNumber(x, step, largest) });
  }
  return ticks;
}

/** Ticks at powers of ten. */
function decadeTicks(scale, step) {
  const first = Math.ceil(scale.lo / step - 1e-9);
  const ticks = [];
  for (let i = 0; i <= TICKS; i++) {
    const at = (first + i) * step;
    if (at <= scale.hi + 1e-9) ticks.push({ at, label: powerOfTen(Math.round(at)) });
  }
  return ticks;
}

function digitsWithin(scale, digits) {
  const found = [];
  for (let n = Math.floor(scale.lo); n <= Math.ceil(scale.hi); n++) {
    for (const digit of digits) {
      const at = n + Math.log10(digit);
      if (at >= scale.lo - 1e-9 && at <= scale.hi + 1e-9) found.push({ digit, exponent: n, at });
    }
  }
  return found;
}

/** Ticks at these digits of each decade. */
function digitTicks(scale, digits) {
  return digitsWithin(scale, digits).map(({ digit, exponent, at }) => ({
    at,
    label: digitLabel(digit, exponent),
  }));
}

/** Logarithmic axes show by small ticks that they are. */
function smallTicks(scale, pixels, named) {
  if (!scale.log) return [];
  const digits = pixels < DECADE * (scale.hi - scale.lo) ? [1] : [1, 2, 3, 4, 5, 6, 7, 8, 9];
  const places = digitsWithin(scale, digits).map(({ at }) => at);
  return places.filter((at) => named.every((tick) => Math.abs(tick.at - at) > 1e-9));
}

/** A digit times a power of ten. */
function digitLabel(digit, exponent) {
  if (exponent >= -3 && exponent <= 0) return (digit * 10 ** exponent).toFixed(-exponent);
  if (exponent >= 1 && exponent <= 3) return String(digit * 10 ** exponent);
  return digit === 1 ? powerOfTen(exponent) : `${digit}·${powerOfTen(exponent)}`;
}

/** A multiple of a step, with as many digits as that needs. */
function plainNumber(x, step, largest) {
  const digits = (exponent) => Math.min(20, Math.max(0, Math.ceil(exponent - Math.log10(step) - 1e-9)));
  if (Math.abs(x) < 1e-6 * step) return "0";
  if (largest >= 1e-4 && largest < 1e6) return x.toFixed(digits(0)).replace("-", "−");
  // One power for all ticks.
  const exponent = Math.floor(Math.log10(largest));
  const mantissa = (x / 10 ** exponent).toFixed(digits(exponent)).replace("-", "−");
  return `${mantissa}·${powerOfTen(exponent)}`;
}

/** 1, 2 or 5 times a power of ten, not less than x. */
function niceStep(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  const made = [1, 2, 5].map((digit) => digit * power).find((step) => step >= x * (1 - 1e-9));
  return made ?? 10 * power;
}

/** 10 to the n, in superscripts. */
function powerOfTen(n) {
  const raised = [...String(Math.abs(n))].map((digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]).join("");
  return `10${n < 0 ? "⁻" : ""}${raised}`;
}
