/** Maps: the cells of a grid filled with colours. */

import { coordinateOf } from "./ticks.js";

/**
 * Breadth of stripes across, at least and at most; between them a part of the breadth of a cell, so that each
 * shows all.
 */
const NARROW = 1.8;
const BROAD = 5;
const OF_CELL = 0.2;

/**
 * Edges as places within the frame; a logarithmic axis has zero infinitely far off, so its cell reaches the
 * frame.
 */
function edgePlaces(edges, scale, place, low, high) {
  return edges.map((edge) =>
    Math.min(high, Math.max(low, place(coordinateOf(scale, Math.max(edge, scale.log ? 0 : edge))))),
  );
}

/**
 * Draws the cells of a map in the frame: grounds with one rectangle for a run of equal cells, and stripes for
 * further colours of a cell.
 */
export function drawCells(surface, map, frame, palette) {
  const columns = map.x_edges.length - 1;
  const rows = map.y_edges.length - 1;
  const x = edgePlaces(map.x_edges, frame.scales.x, (at) => frame.across(at), frame.x, frame.right);
  const y = edgePlaces(map.y_edges, frame.scales.y, (at) => frame.upward(at), frame.y, frame.bottom);
  const [grounds, stripes] = [new Map(), new Map()];
  const under = (of, colour) => of.get(colour) ?? of.set(colour, []).get(colour);
  const shown = Math.min(frame.perX && frame.width / Math.max(1, columns), frame.height / Math.max(1, rows));
  const breadth = Math.min(BROAD, Math.max(NARROW, OF_CELL * shown));
  for (let j = 0; j < rows; j++) {
    const [top, height] = [y[j + 1], y[j] - y[j + 1]];
    if (!(height > 0)) continue;
    for (let i = 0; i < columns; i++) {
      const fill = map.fills[j * columns + i];
      if (!fill?.length) continue;
      let end = i + 1;
      while (end < columns && sameFill(map.fills[j * columns + end], fill)) end += 1;
      const place = { x: x[i], y: top, width: x[end] - x[i], height };
      i = end - 1;
      if (!(place.width > 0)) continue;
      under(grounds, fill[0]).push(place.x, place.y, place.width, place.height);
      for (let k = 1; k < fill.length; k++)
        addStripes(under(stripes, fill[k]), place, breadth, k, fill.length);
    }
  }
  for (const [colour, list] of grounds) surface.rectangles(list, palette.fill(colour));
  for (const [colour, corners] of stripes) surface.area(corners, { colour: palette.fill(colour) });
}

function sameFill(a, b) {
  return a?.length === b.length && a.every((colour, i) => colour === b[i]);
}

/**
 * Adds the corners of the stripe of that number of so many, again and again across a rectangle, in line with
 * others.
 */
function addStripes(corners, { x, y, width, height }, breadth, number, many) {
  const period = breadth * many;
  const [first, last] = [x + y, x + width + y + height];
  for (let turn = Math.floor(first / period) - 1; turn * period <= last; turn++) {
    const a = Math.max(first, turn * period + number * breadth);
    const b = Math.min(last, turn * period + (number + 1) * breadth);
    if (!(a < b)) continue;
    // Where the sum of the coordinates lies between a and b, within the rectangle.
    const at = (sum) => {
      const over = Math.min(x + width, sum - y);
      const under = Math.max(x, sum - y - height);
      return [
        [over, sum - over],
        [under, sum - under],
      ];
    };
    const [[a0, a1], [b0, b1]] = [at(a), at(b)];
    // Between two of its diagonals a rectangle may have corners of its own.
    const right = a < x + width + y && b > x + width + y ? [x + width, y] : [];
    const left = a < x + y + height && b > x + y + height ? [x, y + height] : [];
    corners.push(...a0, ...right, ...b0, ...b1, ...left, ...a1, NaN, NaN);
  }
}
