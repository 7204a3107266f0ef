/** The box around curves in three dimensions, with its axes. */

import { mixColours } from "../draw/palette.js";
import { ticksOf } from "../draw/ticks.js";
import { wordsWidth } from "../draw/words.js";

/** Edges shorter than this have no numbers. */
const SHORT = 30;
/** A name that would lie so many pixels outside of the surface is left out. */
const OUTSIDE = 24;

/** Draws the three far faces with lines at the ticks, and the axes along edges on the outline. */
export function drawBox(surface, seen, palette, space) {
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
