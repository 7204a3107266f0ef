/** The shapes of points and the patterns of lines. */

/** Radius of a circle, and of a dot. */
const RADIUS = 3.9;
const DOT = 1.2;
/** Breadth of outlines, and of the arms of crosses. */
const OUTLINE = 1.5;
const ARM = 2;
/** Breadth of the edge in the colour of the ground, which sets a symbol off from the lines it lies on. */
const EDGE = 1.3;

/** Half of the room that a symbol takes. */
export const SYMBOL_HALF = 6;

const DASHES = {
  solid: [],
  dashed: [7, 4],
  "dash-dot": [9, 3.2, 2, 3.2],
  "dash-dot-dot": [9, 3, 2, 3, 2, 3],
  dotted: [2, 3],
};

/** Returns the lengths of dashes and gaps of a stroke, longer for a line broader than 2 pixels. */
export function dashesOf(stroke, width) {
  return (DASHES[stroke] ?? []).map((length) => length * Math.max(1, width / 2));
}

function regular(x, y, corners, radius, first) {
  const places = [];
  for (let i = 0; i < corners; i++) {
    const angle = 2 * Math.PI * (first + i / corners);
    places.push([x + radius * Math.sin(angle), y - radius * Math.cos(angle)]);
  }
  return places;
}

/** The corners of a symbol that encloses something. */
function symbolCorners(symbol, x, y) {
  switch (symbol) {
    case "dot":
      return regular(x, y, 16, DOT, 0);
    case "square":
      return regular(x, y, 4, 1.25 * RADIUS, 0.125);
    case "diamond":
      return regular(x, y, 4, 1.35 * RADIUS, 0);
    case "triangle":
      return regular(x, y, 3, 1.4 * RADIUS, 0);
    case "star": {
      const dents = regular(x, y, 5, 0.68 * RADIUS, 0.1);
      return regular(x, y, 5, 1.65 * RADIUS, 0).flatMap((tip, i) => [tip, dents[i]]);
    }
    default:
      return regular(x, y, 36, RADIUS, 0);
  }
}

/**
 * Draws a symbol.
 *
 * @param {object} surface
 * @param {{symbol: string, filled: boolean}} look
 * @param {number} x
 * @param {number} y
 * @param {string} colour of this theme
 * @param {string} paper
 */
export function drawSymbol(surface, { symbol, filled }, x, y, colour, paper) {
  if (symbol === "plus" || symbol === "cross") {
    const first = symbol === "plus" ? 0 : 0.125;
    const arms = (radius) => {
      const [a, b, c, d] = regular(x, y, 4, radius, first);
      return [...a, ...c, NaN, NaN, ...b, ...d];
    };
    surface.line(arms(1.2 * RADIUS + EDGE), { colour: paper, width: ARM + 2 * EDGE });
    surface.line(arms(1.2 * RADIUS), { colour, width: ARM });
    return;
  }
  const corners = symbolCorners(symbol, x, y);
  // Past the first corner again, so that the line has a corner there too.
  const outline = [...corners, ...corners.slice(0, 2)].flat();
  surface.line(outline, { colour: paper, width: OUTLINE + 2 * EDGE });
  surface.area(corners.flat(), { colour: filled ? colour : paper });
  surface.line(outline, { colour, width: OUTLINE });
}
