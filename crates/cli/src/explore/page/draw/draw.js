/**
 * Draws pictures from their descriptions: what the command line draws, at any size, in light and dark, and
 * zoomed.
 */

import { drawCells } from "./cells.js";
import { drawAreas, drawCurves } from "./curves.js";
import { Hits } from "./hits.js";
import { layoutOf } from "./layout.js";
import { drawMarks, drawMarksBehind, drawRing } from "./marks.js";
import { paletteOf } from "./palette.js";

/**
 * Draws a picture, or one of its panels, over all of a surface.
 *
 * @param {CanvasSurface | SvgSurface} surface
 * @param {object} description what `Drawing::describe` gives, or one of the panels in it
 * @param {object} view
 * @param {number} view.width in CSS pixels
 * @param {number} view.height
 * @param {{ink?: string, grid?: string, background?: string}} [view.theme] CSS colours
 * @param {{x?: [number, number], y?: [number, number]} | object[]} [view.ranges] in place of those of the
 *   panel; for a picture a list of them, in the order of its panels
 * @param {{panel?: number, series?: number, index?: number, mark?: number, x?: number, y?: number}}
 *   [view.highlight] a series, one of its points, a mark or a pair of values that stands out
 * @param {number} [view.size] of letters, in place of one that suits the width
 * @param {boolean} [view.transparent] without the ground
 * @returns {Hits}
 */
export function draw(surface, description, view) {
  const palette = paletteOf(view.theme);
  surface.clear(view.transparent ? null : palette.paper);
  const { titles, panels } = layoutOf(description, view);
  for (const { text, x, y, size } of titles) surface.words(text, x, y, { colour: palette.ink, size });
  panels.forEach((placed, number) => {
    const { highlight } = view;
    drawPanel(
      surface,
      placed,
      palette,
      highlight && (highlight.panel ?? 0) === number ? highlight : undefined,
    );
  });
  return new Hits(panels);
}

/** One panel, from what lies behind to what lies before. */
function drawPanel(surface, { panel, frame, heading, names, span, left, aside }, palette, highlight) {
  heading.draw(surface, palette, frame.x - aside, frame.y);
  frame.drawNames(surface, palette, names, left, span);
  if (!panel.cells) frame.drawGrid(surface, palette, panel.zero_line);
  surface.clipped(frame.x, frame.y, frame.width, frame.height, () => {
    if (panel.cells) drawCells(surface, panel.cells, frame, palette);
    drawAreas(surface, panel, frame, palette);
    drawMarksBehind(surface, panel, frame, palette);
    const drawn = drawCurves(surface, panel, frame, palette, highlight);
    drawMarks(surface, panel, frame, palette, drawn, highlight);
    drawPointedAt(surface, panel, frame, palette, highlight);
  });
  // Last, as the edges of symbols would cover it.
  frame.drawBorder(surface, palette);
}

function drawPointedAt(surface, panel, frame, palette, highlight) {
  if (!highlight) return;
  const series = panel.series[highlight.series];
  const known = highlight.index !== undefined && series;
  const [x, y] = known ? [series.x[highlight.index], series.y[highlight.index]] : [highlight.x, highlight.y];
  if (x === undefined || y === undefined || x === null || y === null) return;
  const at = frame.place(x, y);
  if (frame.holds(at.x, at.y)) drawRing(surface, at.x, at.y, palette.ink);
}
