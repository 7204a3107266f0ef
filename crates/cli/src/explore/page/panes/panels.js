// Descriptions of panels that are made here, in the form of those that the program sends.

/** Colours that stay apart for the colour-blind (Okabe and Ito 2008). */
export const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000", "#8c564b"];

/** An empty panel with these axes. */
export function panelOf(x, y) {
  return {
    title: "",
    frame: [400, 300],
    x,
    y,
    zero_line: false,
    cells: null,
    areas: [],
    series: [],
    marks: [],
    notes: [],
    strokes: [],
    keys: [],
  };
}

/** A line; `stroke` is "solid" or "dashed". */
export function lineOf(label, x, y, colour, { stroke = "solid", width = 1.5 } = {}) {
  return { label, x, y, dots: false, stroke, width, colour };
}

/** Dots. */
export function dotsOf(label, x, y, colour, width = 1.5) {
  return { label, x, y, dots: true, stroke: "solid", width, colour };
}

/** A symbol with a label beside it. */
export function markOf(x, y, label, { symbol = "circle", filled = true, colour = "#000000", bars = null } = {}) {
  return { x, y, label, offset: [0, -12], symbol, filled, colour, behind: false, bars };
}

/** Curves that run off to infinity in a few of their points are cut where they leave so many times the range of the others. */
const FAR = 12;

/** The range around all numbers but those of curves that run off to infinity. */
export function rangeAroundMost(lists, log = false) {
  const all = lists.flat().filter((x) => Number.isFinite(x) && (!log || x > 0)).sort((a, b) => a - b);
  const whole = rangeAround([all], log);
  if (all.length < 20 || log) return whole;
  const [lo, hi] = [all[Math.floor(0.05 * all.length)], all[Math.floor(0.95 * all.length)]];
  return whole[1] - whole[0] > FAR * (hi - lo) && hi > lo ? rangeAround([[lo - (hi - lo), hi + (hi - lo)]]) : whole;
}

/** The smallest range around all numbers, with a margin; logarithmic axes keep to what is positive. */
export function rangeAround(lists, log = false) {
  let [lo, hi] = [Infinity, -Infinity];
  for (const list of lists) {
    for (const x of list) {
      if (x === null || !Number.isFinite(x) || (log && x <= 0)) continue;
      if (x < lo) lo = x;
      if (x > hi) hi = x;
    }
  }
  if (lo > hi) return log ? [0.1, 10] : [-1, 1];
  if (log) {
    const margin = Math.max(Math.log(hi / lo) * 0.04, 1e-6);
    return [lo * Math.exp(-margin), hi * Math.exp(margin)];
  }
  const margin = (hi - lo) * 0.05 || Math.abs(hi) * 1e-6 || 1;
  return [lo - margin, hi + margin];
}

/** The name of a parameter on an axis, with its unit. */
export function axisLabel(one) {
  const symbol = one.symbol || one.name;
  return one.unit ? `${symbol} [${one.unit}]` : symbol;
}
