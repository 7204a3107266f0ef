/** Curves in three dimensions as they are seen from a direction, without perspective, in a box with axes. */

import { mixColours, paletteOf } from "./palette.js";
import { drawSymbol } from "./symbols.js";
import { ticksOf } from "./ticks.js";
import { wordsWidth } from "./words.js";

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
/** Half the length of the box's sides; curves keep within this part of it. */
const INSIDE = 0.94;
/** Radius of the sphere around the box. */
const SPHERE = Math.sqrt(3);
/** A name that would lie so many pixels outside of the surface is left out. */
const OUTSIDE = 24;
/** Edges shorter than this have no numbers. */
const SHORT = 30;

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
      return { curve, xyz, coarse: coarsePoints(xyz), length: spaceLength(xyz) };
    });
    this.length = this.curves.reduce((sum, one) => sum + one.length, 0);
  }
}

/** The points that a picture in motion needs: each at some distance from the one before. */
function coarsePoints(xyz) {
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
      if (step < COARSE) continue;
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
  const layers = space.curves.map((one) => layersOf(quick ? one.coarse : one.xyz, seen));
  for (let layer = 0; layer < LAYERS; layer++) {
    const nearness = layer / (LAYERS - 1);
    space.curves.forEach(({ curve }, i) => {
      const colour = mixColours(palette.line(curve.colour), palette.paper, FADED * (1 - nearness));
      const breadth = (curve.width ?? width) * (FARTHEST + (1 - FARTHEST) * nearness);
      if (layers[i][layer].length) surface.line(layers[i][layer], { colour, width: breadth, round: true });
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

/** The three far faces with lines at the ticks, and the axes along edges on the near side. */
function drawBox(surface, seen, palette, space) {
  const far = seen.near.map((part) => (part > 0 ? -1 : 1));
  const corner = (at) => seen.place(at).slice(0, 2);
  const axes = [0, 1, 2].map((axis) => axisEdge(axis, far, seen));
  const ticks = axes.map(({ from, to }, axis) => {
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const level = Math.abs(to[0] - from[0]) / Math.max(length, 1e-9);
    const scale = space.scales[axis];
    if (length < SHORT) return { named: [] };
    return ticksOf(
      scale,
      length,
      (list) =>
        list.length <= 7 &&
        list.every((tick, i) => {
          if (i === 0) return true;
          const apart = ((tick.at - list[i - 1].at) / (scale.hi - scale.lo)) * length;
          const wide =
            0.5 * (wordsWidth(tick.label, seen.size) + wordsWidth(list[i - 1].label, seen.size)) + 6;
          return (
            apart >=
            Math.min(
              wide / Math.max(level, 1e-6),
              (1.35 * seen.size) / Math.sqrt(Math.max(1e-6, 1 - level ** 2)),
            )
          );
        }),
    );
  });
  const share = (tick, axis) =>
    (2 * (tick.at - space.scales[axis].lo)) / (space.scales[axis].hi - space.scales[axis].lo) - 1;
  const [grid, sides] = [[], []];
  for (const face of [0, 1, 2]) {
    const [a, b] = [0, 1, 2].filter((axis) => axis !== face);
    const at = (one, other) => {
      const place = [];
      [place[face], place[a], place[b]] = [far[face], one, other];
      return corner(place);
    };
    for (const tick of ticks[a].named)
      grid.push(...at(share(tick, a), -1), ...at(share(tick, a), 1), NaN, NaN);
    for (const tick of ticks[b].named)
      grid.push(...at(-1, share(tick, b)), ...at(1, share(tick, b)), NaN, NaN);
    sides.push(
      ...[
        [-1, -1],
        [1, -1],
        [1, 1],
        [-1, 1],
        [-1, -1],
      ].flatMap(([one, other]) => at(one, other)),
      NaN,
      NaN,
    );
  }
  surface.line(grid, { colour: palette.grid, width: 0.8 });
  surface.line(sides, { colour: mixColours(palette.ink, palette.paper, 0.6), width: 0.8 });
  // Numbers of one axis keep off those of the others, and names off all numbers.
  const taken = [];
  const names = axes.map((edge, axis) => {
    const places = ticks[axis].named.map((tick) => ({
      label: tick.label,
      part: 0.5 * (1 + share(tick, axis)),
    }));
    return drawAxis(surface, seen, palette, edge, places, taken);
  });
  names.forEach((draw, axis) => draw?.(space.content.labels[axis]));
}

/**
 * The edge of the box along which an axis has its numbers: where these stand outside of the picture of the
 * box.
 */
function axisEdge(axis, far, seen) {
  const [a, b] = [0, 1, 2].filter((other) => other !== axis);
  const edges = [];
  for (const one of [-1, 1]) {
    for (const other of [-1, 1]) {
      const ends = [-1, 1].map((along) => {
        const place = [];
        [place[axis], place[a], place[b]] = [along, one, other];
        return seen.place(place);
      });
      // An edge of one far face and one near face is on the outline.
      if ((one === far[a]) !== (other === far[b])) edges.push({ from: ends[0], to: ends[1] });
    }
  }
  const middle = ({ from, to }, i) => 0.5 * (from[i] + to[i]);
  // The vertical axis stands at the left, the others below.
  const better = axis === 2 ? (x, y) => middle(x, 0) < middle(y, 0) : (x, y) => middle(x, 1) > middle(y, 1);
  return edges.length < 2 || better(edges[0], edges[1]) ? edges[0] : edges[1];
}

/** Draws an axis with its numbers, and returns how its name is written. */
function drawAxis(surface, seen, palette, { from, to }, ticks, taken) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  surface.line([from[0], from[1], to[0], to[1]], { colour: palette.ink, width: 1 });
  if (length < SHORT) return null;
  // Across the edge, away from the box.
  let [ox, oy] = [dy / length, -dx / length];
  const [mx, my] = [0.5 * (from[0] + to[0]) - seen.middle[0], 0.5 * (from[1] + to[1]) - seen.middle[1]];
  if (ox * mx + oy * my < 0) [ox, oy] = [-ox, -oy];
  const { size } = seen;
  const look = { colour: palette.ink, size, align: "middle" };
  const free = (box) => taken.every((other) => !overlap(box, other));
  let widest = 0;
  for (const { label, part } of ticks) {
    const [x, y] = [from[0] + part * dx, from[1] + part * dy];
    surface.line([x, y, x + 4 * ox, y + 4 * oy], { colour: palette.ink, width: 0.9 });
    const half = 0.5 * wordsWidth(label, size);
    const away = 7 + reach(ox, oy, half, 0.5 * size);
    const box = { x: x + away * ox, y: y + away * oy, halfX: half + 2, halfY: 0.5 * size };
    if (!free(box)) continue;
    taken.push(box);
    widest = Math.max(widest, half);
    surface.words(label, box.x, box.y, look);
  }
  return (name) => {
    const half = 0.5 * wordsWidth(name, size);
    // Upright axes have their name turned, as others have.
    const upwards = Math.abs(dy) > 2.2 * Math.abs(dx);
    const [halfX, halfY] = upwards ? [0.5 * size, half] : [half, 0.5 * size];
    const away = 11 + 2 * reach(ox, oy, widest, 0.5 * size) + reach(ox, oy, halfX, halfY);
    const inside = (at, room, most) => Math.min(most - room - 2, Math.max(room + 2, at));
    const places = [0.5, 0.4, 0.6, 0.3, 0.7].flatMap((part) => {
      const wanted = [from[0] + part * dx + away * ox, from[1] + part * dy + away * oy];
      const [x, y] = [inside(wanted[0], halfX, surface.width), inside(wanted[1], halfY, surface.height)];
      return Math.hypot(x - wanted[0], y - wanted[1]) < OUTSIDE ? [{ x, y, halfX, halfY }] : [];
    });
    const box = places.find(free) ?? places[0];
    if (!box) return;
    taken.push(box);
    surface.words(name, box.x, box.y, { ...look, upwards, halo: palette.paper });
  };
}

function overlap(a, b) {
  return Math.abs(a.x - b.x) < a.halfX + b.halfX && Math.abs(a.y - b.y) < a.halfY + b.halfY;
}

/** How far the middle of words of that size is from an edge that touches them, in the direction given. */
function reach(ox, oy, halfX, halfY) {
  return Math.abs(ox) * halfX + Math.abs(oy) * halfY;
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
