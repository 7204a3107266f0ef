/** Curves in three dimensions as they are seen from a direction, without perspective, in a box with axes. */

import { drawBox } from "./box.js";
import { mixColours, paletteOf } from "../draw/palette.js";
import { drawSymbol } from "../draw/symbols.js";
import { wordsWidth } from "../draw/words.js";

/** Curves are drawn in so many layers from back to front, each with its own look. */
const LAYERS = 8;
/**
 * Part of the ground in the colour of the farthest layer, and its breadth as a part of that of the nearest.
 */
const FADED = 0.55;
const FARTHEST = 0.6;
/**
 * Breadth of curves, at most and at least, and how much of the surface they may cover before they become
 * finer.
 */
const BROAD = 1.7;
const FINE = 0.6;
const COVERED = 0.3;
/** Steps shorter than this part of the box are left out while it turns, and so many pixels at all times. */
const COARSE = 0.006;
const PIXEL = 0.6;
/**
 * Of curves with more points than this longer steps are left out, up to these, and lines are as fine as the
 * screen.
 */
const MOVING = 20000;
const COARSEST = 0.04;
const HAIRLINES = 4000;
/** Half the length of the box's sides; curves keep within this part of it. */
const INSIDE = 0.94;
/** Radius of the sphere around the box. */
const SPHERE = Math.sqrt(3);

/** The least and largest of lists of numbers. */
function extent(lists) {
  let [lo, hi] = [Infinity, -Infinity];
  for (const list of lists) {
    for (const value of list) {
      if (value === null || !Number.isFinite(value)) continue;
      if (value < lo) lo = value;
      if (value > hi) hi = value;
    }
  }
  if (lo > hi) return [-1, 1];
  const least = 1e-9 * Math.max(Math.abs(lo), Math.abs(hi)) || 1;
  return hi - lo > least ? [lo, hi] : [lo - 0.5 * Math.max(least, 1e-12), hi + 0.5 * Math.max(least, 1e-12)];
}

/**
 * Curves and marks in the coordinates of the box, from -1 to 1.
 *
 * @typedef {{labels: [string, string, string], log?: boolean[], curves: {x: number[], y: number[], z:
 *   number[], colour: string, label?: string, width?: number}[], marks?: {x: number, y: number, z: number,
 *   label?: string, symbol?: string, filled?: boolean, colour?: string}[]}} SpaceContent `log` says of which
 *   axes the numbers are decimal logarithms that the ticks should show as powers
 */
export class Space {
  /** @param {SpaceContent} content */
  constructor(content) {
    this.content = content;
    const { curves } = content;
    const marks = content.marks ?? [];
    const ranges = ["x", "y", "z"].map((name) =>
      extent([...curves.map((curve) => curve[name]), marks.map((mark) => mark[name])]),
    );
    this.scales = ranges.map(([lo, hi], i) => {
      const margin = (0.5 * (hi - lo) * (1 - INSIDE)) / INSIDE;
      return { lo: lo - margin, hi: hi + margin, log: Boolean(content.log?.[i]) };
    });
    const placed = (value, i) => {
      const { lo, hi } = this.scales[i];
      return value === null ? NaN : (2 * (value - lo)) / (hi - lo) - 1;
    };
    this.marks = marks.map((mark) => ({ mark, at: [mark.x, mark.y, mark.z].map(placed) }));
    this.curves = curves.map((curve) => {
      const count = Math.min(curve.x.length, curve.y.length, curve.z.length);
      const xyz = new Float64Array(3 * count);
      for (let i = 0; i < count; i++) {
        xyz[3 * i] = placed(curve.x[i], 0);
        xyz[3 * i + 1] = placed(curve.y[i], 1);
        xyz[3 * i + 2] = placed(curve.z[i], 2);
      }
      return { curve, xyz, coarse: coarsened(xyz), length: spaceLength(xyz) };
    });
    this.length = this.curves.reduce((sum, one) => sum + one.length, 0);
  }
}

/** The points that a picture in motion needs. */
function coarsened(xyz) {
  let [apart, kept] = [COARSE, coarsePoints(xyz, COARSE)];
  while (kept.length > 3 * MOVING && apart < COARSEST) {
    apart *= 1.6;
    kept = coarsePoints(xyz, apart);
  }
  return kept;
}

/** Points each at some distance from the one before. */
function coarsePoints(xyz, apart) {
  const kept = [];
  let last = -1;
  const count = xyz.length / 3;
  for (let i = 0; i < count; i++) {
    const known = xyz[3 * i] + xyz[3 * i + 1] + xyz[3 * i + 2];
    if (known === known && last >= 0 && i < count - 1) {
      const step = Math.hypot(
        xyz[3 * i] - xyz[3 * last],
        xyz[3 * i + 1] - xyz[3 * last + 1],
        xyz[3 * i + 2] - xyz[3 * last + 2],
      );
      if (step < apart) continue;
    }
    kept.push(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
    last = known === known ? i : -1;
  }
  return Float64Array.from(kept);
}

function spaceLength(xyz) {
  let sum = 0;
  for (let i = 3; i < xyz.length; i += 3) {
    const step = Math.hypot(xyz[i] - xyz[i - 3], xyz[i + 1] - xyz[i - 2], xyz[i + 2] - xyz[i - 1]);
    if (step === step) sum += step;
  }
  return sum;
}

/** A direction of view: where places of the box are on the surface, and how near. */
export class SpaceView {
  /**
   * @param {{azimuth: number, elevation: number, zoom: number}} turned angles in degrees
   * @param {{width: number, height: number}} view
   */
  constructor({ azimuth, elevation, zoom }, { width, height }) {
    const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
    this.size = Math.min(width, height) < 240 ? 10.5 : 12;
    // However it is turned around the upright axis, the box and its labels have room.
    const across = (0.5 * width - 3.4 * this.size) / Math.SQRT2;
    const down = (0.5 * height - 3 * this.size) / (Math.SQRT2 * Math.abs(Math.sin(e)) + Math.cos(e));
    const scale = zoom * Math.max(15, Math.min(across, down));
    this.scale = scale;
    this.middle = [width / 2, height / 2];
    this.across = [-scale * Math.sin(a), scale * Math.cos(a), 0];
    this.down = [scale * Math.sin(e) * Math.cos(a), scale * Math.sin(e) * Math.sin(a), -scale * Math.cos(e)];
    this.near = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
  }

  /** Where a place of the box is: x and y on the surface, and its depth, larger for nearer ones. */
  place([x, y, z]) {
    const of = ([a, b, c]) => a * x + b * y + c * z;
    return [this.middle[0] + of(this.across), this.middle[1] + of(this.down), of(this.near)];
  }
}

/**
 * Draws curves in three dimensions over all of a surface.
 *
 * @param {CanvasSurface | SvgSurface} surface
 * @param {Space} space
 * @param {{width: number, height: number, theme?: object, transparent?: boolean}} view
 * @param {{azimuth: number, elevation: number, zoom: number}} turned
 * @param {boolean} [quick] leaves out points that a picture in motion does not need
 */
export function drawSpace(surface, space, view, turned, quick = false) {
  const palette = paletteOf(view.theme);
  surface.clear(view.transparent ? null : palette.paper);
  const seen = new SpaceView(turned, view);
  drawBox(surface, seen, palette, space);
  // As much as they cover, they become finer.
  const covered = (0.6 * space.length * seen.scale * BROAD) / (4 * seen.scale * seen.scale);
  const width = Math.max(FINE, BROAD * Math.min(1, COVERED / Math.max(covered, 1e-9)));
  const many = space.curves.reduce((sum, one) => sum + one.coarse.length / 3, 0) > HAIRLINES;
  const most = quick && many ? 1 / surface.ratio : Infinity;
  const layers = space.curves.map((one) => layersOf(quick ? one.coarse : one.xyz, seen));
  for (let layer = 0; layer < LAYERS; layer++) {
    const nearness = layer / (LAYERS - 1);
    space.curves.forEach(({ curve }, i) => {
      const colour = mixColours(palette.line(curve.colour), palette.paper, FADED * (1 - nearness));
      const breadth = (curve.width ?? width) * (FARTHEST + (1 - FARTHEST) * nearness);
      if (!layers[i][layer].length) return;
      surface.line(layers[i][layer], { colour, width: Math.min(breadth, most), round: true });
    });
  }
  drawSpaceMarks(surface, space, seen, palette);
  drawSpaceLegend(surface, space, palette, seen.size);
}

/** The stretches of a curve by their depth, as places x, y with NaN between them. */
function layersOf(xyz, seen) {
  const layers = Array.from({ length: LAYERS }, () => []);
  const [[ax, ay, az], [dx, dy, dz], [nx, ny, nz], [mx, my]] = [
    seen.across,
    seen.down,
    seen.near,
    seen.middle,
  ];
  const perDepth = LAYERS / (2 * SPHERE * 0.8);
  let [px, py, open] = [NaN, NaN, -1];
  for (let i = 0; i < xyz.length; i += 3) {
    const [x, y, z] = [xyz[i], xyz[i + 1], xyz[i + 2]];
    const sx = mx + ax * x + ay * y + az * z;
    const sy = my + dx * x + dy * y + dz * z;
    if (sx !== sx) {
      [px, py, open] = [NaN, NaN, -1];
      continue;
    }
    if (Math.abs(sx - px) < PIXEL && Math.abs(sy - py) < PIXEL && i < xyz.length - 3) continue;
    if (px === px) {
      const depth = Math.floor(LAYERS / 2 + perDepth * (nx * x + ny * y + nz * z));
      const layer = depth < 0 ? 0 : depth >= LAYERS ? LAYERS - 1 : depth;
      if (layer !== open) layers[layer].push(NaN, NaN, px, py);
      layers[layer].push(sx, sy);
      open = layer;
    }
    [px, py] = [sx, sy];
  }
  return layers;
}

function drawSpaceMarks(surface, space, seen, palette) {
  const placed = space.marks.map(({ mark, at }) => ({ mark, at: seen.place(at) }));
  placed.sort((a, b) => a.at[2] - b.at[2]);
  const taken = [];
  for (const {
    mark,
    at: [x, y],
  } of placed) {
    if (!(x === x && y === y)) continue;
    const colour = mark.colour ?? "#961E1E";
    const look = { symbol: mark.symbol ?? "circle", filled: mark.filled ?? true };
    drawSymbol(surface, look, x, y, palette.line(colour), palette.paper);
    if (!mark.label) continue;
    const half = 0.5 * wordsWidth(mark.label, seen.size) + 2;
    const places = [
      [0, -13],
      [0, 13],
      [half + 8, 0],
      [-half - 8, 0],
    ].map(([dx, dy]) => [x + dx, y + dy]);
    const free = ([a, b]) =>
      taken.every(([c, d, other]) => Math.abs(a - c) > half + other || Math.abs(b - d) > seen.size);
    const at = places.find(free);
    if (!at) continue;
    taken.push([...at, half]);
    const words = { colour: palette.word(colour), size: seen.size, align: "middle", halo: palette.paper };
    surface.words(mark.label, at[0], at[1], words);
  }
}

/** The names of the curves, in a column at the top left. */
function drawSpaceLegend(surface, space, palette, size) {
  const named = space.curves.filter(({ curve }) => curve.label);
  named.forEach(({ curve }, i) => {
    const y = 4 + 1.4 * size * (i + 0.5);
    surface.line([6, y, 26, y], { colour: palette.line(curve.colour), width: BROAD });
    surface.words(curve.label, 32, y, { colour: palette.word(curve.colour), size, halo: palette.paper });
  });
}
