/**
 * Curves, dots and areas of a panel in its frame: thinned to what the pixels can show, and cut at the frame.
 */

import { dashesOf } from "./symbols.js";

/** Lines go on so far beyond the frame, so that their ends are not seen. */
const BEYOND = 6;
/** Points per pixel of width above which runs within a column of pixels are replaced by their extremes. */
const DENSE = 2;
/**
 * Points of other curves nearer to the one before than this are left out; of more than so many, nearer than
 * that.
 */
const CLOSE = 0.6;
const MANY = 300000;
const CLOSE_OF_MANY = 2;
/** Lines of more places than this are drawn one pixel of the screen broad at most, which is much faster. */
const HAIRLINES = 2000;
/** A line longer than this fills an area, where no pattern can be seen: it is drawn unbroken. */
const FILLS = 60000;
/** Room between a curve and the map that it lies on. */
const CASING = 1;
/** Distance of the places by which a curve knows that it was there before. */
const STEP = 0.5;
/** What comes as near as this to itself, after and over at least so many steps, is there again. */
const NEAR = 0.7;
const AGAIN = 28;

const coordinates = new WeakMap();

/**
 * Returns the coordinates of a series as typed arrays, which are kept: `y` is NaN where the curve breaks, `x`
 * grows if `sorted`, and repeats the last one there.
 *
 * @param {{x: number[], y: number[]}} series
 * @param {{x: {log: boolean}, y: {log: boolean}}} scales
 * @returns {{x: Float64Array, y: Float64Array, sorted: boolean}}
 */
export function seriesCoordinates(series, scales) {
  const key = `${scales.x.log}${scales.y.log}${series.x.length}`;
  const found = coordinates.get(series);
  if (found?.key === key) return found;
  const count = Math.min(series.x.length, series.y.length);
  const [x, y] = [new Float64Array(count), new Float64Array(count)];
  let [last, sorted] = [-Infinity, true];
  for (let i = 0; i < count; i++) {
    const [a, b] = [series.x[i], series.y[i]];
    const across = a === null ? NaN : scales.x.log ? Math.log10(a) : a;
    const up = b === null ? NaN : scales.y.log ? Math.log10(b) : b;
    const finite = Number.isFinite(across) && Number.isFinite(up);
    y[i] = finite ? up : NaN;
    if (finite) {
      sorted &&= across >= last;
      last = across;
    }
    x[i] = last;
  }
  const made = { key, x, y, sorted };
  coordinates.set(series, made);
  return made;
}

/** Returns the first place in a growing list where it is not less than `value`. */
export function firstNotBelow(list, value) {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Collects a line cut at a box, as a flat list of places with NaN between pieces. */
class CutLine {
  constructor(left, top, right, bottom) {
    Object.assign(this, { left, top, right, bottom, xy: [], x: NaN, y: NaN, open: false });
  }

  break() {
    // A point alone is drawn as a short line.
    if (this.x === this.x && !this.open && this.single) this.put(this.x, this.y, this.x + 0.01, this.y);
    this.x = NaN;
    this.open = false;
  }

  put(x0, y0, x1, y1) {
    const { xy } = this;
    if (!this.open) xy.push(NaN, NaN, x0, y0);
    xy.push(x1, y1);
  }

  to(x, y) {
    const x0 = this.x;
    const y0 = this.y;
    this.x = x;
    this.y = y;
    if (x0 !== x0) {
      this.single = this.holds(x, y);
      return;
    }
    this.single = false;
    if (this.holds(x0, y0) && this.holds(x, y)) {
      this.put(x0, y0, x, y);
      this.open = true;
      return;
    }
    this.cut(x0, y0, x, y);
  }

  holds(x, y) {
    return x >= this.left && x <= this.right && y >= this.top && y <= this.bottom;
  }

  /** Adds what of a step lies in the box, if anything. */
  cut(x0, y0, x1, y1) {
    const [dx, dy] = [x1 - x0, y1 - y0];
    let [from, to] = [0, 1];
    const sides = [
      [-dx, x0 - this.left],
      [dx, this.right - x0],
      [-dy, y0 - this.top],
      [dy, this.bottom - y0],
    ];
    for (const [rate, room] of sides) {
      if (rate === 0) {
        if (room < 0) from = 2;
      } else if (rate < 0) from = Math.max(from, room / rate);
      else to = Math.min(to, room / rate);
    }
    if (from >= to) {
      this.open = false;
      return;
    }
    if (from > 0) this.open = false;
    this.put(x0 + from * dx, y0 + from * dy, x0 + to * dx, y0 + to * dy);
    this.open = to === 1;
  }
}

/**
 * Returns the line of a series on the surface, cut at the frame: where many points share a column of pixels,
 * the first, the least, the largest and the last of each run.
 *
 * @returns {number[]} places x, y, with NaN between pieces
 */
export function linePlaces(series, frame) {
  const { x, y, sorted } = seriesCoordinates(series, frame.scales);
  const { lo, hi } = frame.scales.x;
  const margin = (BEYOND / frame.width) * (hi - lo);
  const first = sorted ? Math.max(0, firstNotBelow(x, lo - margin) - 1) : 0;
  const last = sorted ? Math.min(x.length, firstNotBelow(x, hi + margin) + 1) : x.length;
  const line = new CutLine(frame.x - BEYOND, frame.y - BEYOND, frame.right + BEYOND, frame.bottom + BEYOND);
  const [x0, perX] = [frame.x - frame.scales.x.lo * frame.perX, frame.perX];
  const [y0, perY] = [frame.bottom + frame.scales.y.lo * frame.perY, frame.perY];
  const place = (i) => line.to(x0 + perX * x[i], y0 - perY * y[i]);
  if (sorted && last - first > DENSE * frame.width) {
    addRuns(line, place, { x, y, first, last, column: (i) => Math.floor(x0 + perX * x[i]) });
    return line.xy;
  }
  const apart = steps(last - first, frame);
  let skipped = -1;
  for (let i = first; i < last; i++) {
    const px = x0 + perX * x[i];
    const py = y0 - perY * y[i];
    if (py !== py) {
      if (skipped >= 0) place(skipped);
      line.break();
      skipped = -1;
    } else if (Math.abs(px - line.x) + Math.abs(py - line.y) < apart) skipped = i;
    else {
      line.to(px, py);
      skipped = -1;
    }
  }
  if (skipped >= 0) place(skipped);
  line.break();
  return line.xy;
}

/** How far apart the points of a curve are at least that is drawn, in pixels: none of few is left out. */
function steps(count, frame) {
  if (count <= DENSE * frame.width) return 0;
  return count < MANY ? CLOSE : CLOSE_OF_MANY;
}

/**
 * Adds the runs of a curve that grows within each column of pixels: the first point, the extremes and the
 * last.
 */
function addRuns(line, place, { x, y, first, last, column }) {
  let begin = first;
  let low = first;
  let high = first;
  let end = -1;
  let current = NaN;
  const flush = () => {
    if (end < begin) return;
    place(begin);
    const one = Math.min(low, high);
    const other = Math.max(low, high);
    if (one > begin && one < end) place(one);
    if (other > one && other < end) place(other);
    if (end > begin) place(end);
    end = -1;
  };
  for (let i = first; i < last; i++) {
    const up = y[i];
    if (up !== up) {
      flush();
      line.break();
      current = NaN;
      continue;
    }
    const here = column(i);
    if (here !== current) {
      flush();
      current = here;
      begin = i;
      low = i;
      high = i;
    } else if (up < y[low]) low = i;
    else if (up > y[high]) high = i;
    end = i;
  }
  flush();
  line.break();
}

/** The places of dots in the frame, each half pixel once. */
function dotPlaces(series, frame, radius) {
  const { x, y } = seriesCoordinates(series, frame.scales);
  const fine = x.length > 20000 ? 1 : 2;
  const across = Math.ceil(fine * frame.width) + 2;
  const seen = new Uint8Array(across * (Math.ceil(fine * frame.height) + 2));
  const xy = [];
  for (let i = 0; i < x.length; i++) {
    const [px, py] = [frame.across(x[i]), frame.upward(y[i])];
    if (!frame.holds(px, py, 0.01)) continue;
    const square = Math.round(fine * (px - frame.x)) + across * Math.round(fine * (py - frame.y));
    if (seen[square]) continue;
    seen[square] = 1;
    xy.push(px, py);
  }
  return xy;
}

/**
 * The stretches of a line that do not follow an earlier one: cycles drawn one over the other would fill the
 * gaps of dashes.
 */
function firstTimes(xy, frame) {
  const across = Math.ceil((frame.width + 2 * BEYOND) / NEAR) + 4;
  const down = Math.ceil((frame.height + 2 * BEYOND) / NEAR) + 4;
  const visits = new Int32Array(across * down);
  const out = [];
  let time = 0;
  let [pending, kept] = [[], false];
  const visit = (x, y) => {
    const i = Math.floor((x - frame.x + BEYOND) / NEAR) + 1;
    const j = Math.floor((y - frame.y + BEYOND) / NEAR) + 1;
    let again = false;
    for (let dj = -1; dj <= 1; dj++) {
      for (let di = -1; di <= 1; di++) {
        const seen = visits[i + di + across * (j + dj)];
        again ||= seen > 0 && time > seen + AGAIN;
      }
    }
    time += 1;
    visits[i + across * j] ||= time;
    return again;
  };
  const put = (x, y, again) => {
    if (again) {
      pending.push(x, y);
      if (pending.length > 2 * AGAIN) kept = false;
      return;
    }
    if (pending.length <= 2 * AGAIN && kept) out.push(...pending);
    else out.push(NaN, NaN);
    pending = [];
    kept = true;
    out.push(x, y);
  };
  let [x0, y0] = [NaN, NaN];
  for (let i = 0; i < xy.length; i += 2) {
    const [x, y] = [xy[i], xy[i + 1]];
    if (x !== x) {
      if (kept && pending.length <= 2 * AGAIN) out.push(...pending);
      [pending, kept] = [[], false];
    } else {
      const pieces = x0 === x0 ? Math.max(1, Math.ceil(Math.hypot(x - x0, y - y0) / STEP)) : 1;
      for (let k = 1; k <= pieces; k++) {
        const part = k / pieces;
        const [a, b] = x0 === x0 ? [x0 + part * (x - x0), y0 + part * (y - y0)] : [x, y];
        put(a, b, visit(a, b));
      }
    }
    [x0, y0] = [x, y];
  }
  if (kept && pending.length <= 2 * AGAIN) out.push(...pending);
  return out;
}

function lineLength(xy) {
  let sum = 0;
  for (let i = 2; i < xy.length; i += 2) {
    const step = Math.hypot(xy[i] - xy[i - 2], xy[i + 1] - xy[i - 1]);
    if (step === step) sum += step;
  }
  return sum;
}

/** How broad a series is drawn: finer on small frames, and broader where a part of a dense curve is seen. */
export function drawnWidth(series, panel, frame) {
  const small = panel.frame ? Math.min(1, Math.max(0.65, Math.sqrt(frame.width / panel.frame[0]))) : 1;
  const width = series.width * small;
  if (series.dots || width >= 1.2) return width;
  const whole = panel.x.log
    ? Math.log10(panel.x.range[1] / panel.x.range[0])
    : panel.x.range[1] - panel.x.range[0];
  const part = Math.abs((frame.scales.x.hi - frame.scales.x.lo) / whole);
  return Math.min(1.3, width / Math.sqrt(Math.min(1, part)));
}

/** Draws the areas of a panel. */
export function drawAreas(surface, panel, frame, palette) {
  const far = (at, low, high) => Math.min(high + 5000, Math.max(low - 5000, at));
  for (const area of panel.areas) {
    for (const piece of area.pieces) {
      const corners = [];
      for (let i = 0; i < piece.x.length; i++) {
        if (piece.x[i] === null || piece.y[i] === null) continue;
        const { x, y } = frame.place(piece.x[i], piece.y[i]);
        if (x === x && y === y) corners.push(far(x, frame.x, frame.right), far(y, frame.y, frame.bottom));
      }
      if (corners.length > 4)
        surface.area(corners, { colour: palette.line(area.colour), opacity: area.opacity });
    }
  }
}

/**
 * Draws the curves and dots of a panel.
 *
 * @param {object} surface
 * @param {object} panel
 * @param {PanelFrame} frame
 * @param {object} palette
 * @param {{series?: number}} [highlight] the others become pale
 * @returns {{xy: number[], dots: boolean}[]} what is drawn of each
 */
export function drawCurves(surface, panel, frame, palette, highlight) {
  return panel.series.map((series, number) => {
    const chosen = highlight?.series;
    const opacity = chosen === undefined || chosen === null || chosen === number ? 1 : 0.3;
    const width = drawnWidth(series, panel, frame) + (chosen === number ? 0.8 : 0);
    const colour = palette.line(series.colour);
    if (series.dots) {
      const xy = dotPlaces(series, frame, width);
      if (panel.cells) surface.dots(xy, { colour: palette.paper, radius: width + CASING });
      surface.dots(xy, { colour: opacity < 1 ? palette.grid : colour, radius: width });
      return { xy, dots: true };
    }
    const xy = linePlaces(series, frame);
    if (panel.cells) surface.line(xy, { colour: palette.paper, width: width + 2 * CASING });
    let [dash, drawn] = [dashesOf(series.stroke, width), xy];
    if (dash.length) {
      if (lineLength(xy) >= FILLS) dash = [];
      else if (!seriesCoordinates(series, frame.scales).sorted) drawn = firstTimes(xy, frame);
    }
    const breadth = xy.length > 2 * HAIRLINES ? Math.min(width, 1 / surface.ratio) : width;
    surface.line(drawn, { colour, width: breadth, dash, opacity });
    return { xy, dots: false };
  });
}
