/** The heading of a panel: its title and the legend, above the frame so that nothing covers the curves. */

import { mixColours } from "./palette.js";
import { dashesOf, drawSymbol, SYMBOL_HALF } from "./symbols.js";
import { cutWords, wordsWidth, wrapWords } from "./words.js";

/** Height of one line, in sizes of letters, and the room above the first line and below the last. */
const LINE = 1.5;
const AROUND = 6;
/** Room after the title, and after an entry. */
const AFTER_TITLE = 20;
const AFTER_ENTRY = 15;
/** Length of a line's sample: more than one turn of any pattern. */
const SAMPLE = 30;
/** Room between a sample and its name. */
const GAP = 6;
/** Side of a square, and breadth of its outline. */
const SQUARE = 11;
const OUTLINE = 0.6;
/** Lines and points of the legend are not finer than this. */
const FINEST = 1.6;

/**
 * What the legend explains: the sample before the words, these, and their colour; null for that of the axes.
 */
function legendEntries(panel) {
  const entries = [];
  for (const swatch of panel.cells?.swatches ?? []) {
    const sample = swatch.colours.length ? { kind: "fills", colours: swatch.colours } : { kind: "none" };
    entries.push({ sample, text: swatch.label, colour: null });
  }
  for (const series of panel.series) {
    const width = Math.max(series.width, FINEST);
    const { colour, stroke } = series;
    const sample = series.dots ? { kind: "dots", width, colour } : { kind: "line", width, colour, stroke };
    entries.push({ sample, text: series.label, colour });
  }
  const areas = new Map();
  for (const { label, colour, opacity } of panel.areas) {
    if (!label) continue;
    const sample = areas.get(label) ?? { kind: "veils", colours: [] };
    if (!sample.colours.some((other) => other.colour === colour)) sample.colours.push({ colour, opacity });
    areas.set(label, sample);
  }
  for (const [text, sample] of areas) entries.push({ sample, text, colour: null });
  for (const { stroke, label } of panel.strokes) {
    entries.push({
      sample: { kind: "line", width: FINEST, stroke, colour: null },
      text: label,
      colour: null,
    });
  }
  for (const key of panel.keys)
    entries.push({ sample: { kind: "symbol", ...key }, text: key.label, colour: null });
  return entries.filter((entry) => entry.text);
}

/** The room before the words. */
function sampleWidth(sample) {
  switch (sample.kind) {
    case "line":
      return SAMPLE + GAP;
    case "dots":
    case "symbol":
      return 2 * SYMBOL_HALF + GAP;
    case "fills":
    case "veils":
      return SQUARE * sample.colours.length + GAP;
    default:
      return 0;
  }
}

/** Entries set one after the other; those without room on a line go to the next. */
class LegendFlow {
  constructor(limit, size) {
    Object.assign(this, { limit, size, used: 0, lines: 1, placed: [] });
  }

  add(sample, text, colour, after, strong = false) {
    const { limit, size } = this;
    const before = sampleWidth(sample);
    // The title is a little wider as it is strong.
    const wider = strong ? 1.07 : 1;
    wrapWords(text, size * wider, Math.max(1, limit - before)).forEach((line, i) => {
      const whole = before + wider * wordsWidth(line, size);
      if (this.used > 0 && (i > 0 || this.used + whole > limit)) {
        this.lines += 1;
        this.used = 0;
      }
      const indent = i === 0 ? 0 : before;
      const at = { x: this.used + indent, line: this.lines };
      this.placed.push({ at, sample: i === 0 ? sample : { kind: "none" }, text: line, colour, strong });
      this.used += whole + after;
    });
  }
}

function arranged(panel, limit, size, titleAlone, entries) {
  const flow = new LegendFlow(limit, size);
  if (panel.title) {
    flow.add({ kind: "none" }, panel.title, null, AFTER_TITLE);
    if (titleAlone && entries.length) flow.used = Math.max(flow.used, limit);
  }
  for (const { sample, text, colour } of entries) flow.add(sample, text, colour, AFTER_ENTRY);
  return flow;
}

/**
 * Arranges the title and the legend of a panel on lines of a length. Where the lines allowed are fewer than
 * it needs, the legend is left out, and the title is cut.
 *
 * @param {object} panel
 * @param {number} limit
 * @param {number} size of letters
 * @param {number} [most] lines allowed
 * @returns {{height: number, lines: number, whole: boolean, draw: (surface: object, palette: object, x:
 *   number, bottom: number) => void}} `whole`: nothing was left out
 */
export function headingOf(panel, limit, size, most = Infinity) {
  const entries = legendEntries(panel);
  let flow = arranged(panel, limit, size, false, entries);
  if (flow.lines > 1) flow = arranged(panel, limit, size, true, entries);
  const whole = flow.lines <= most;
  if (!whole) {
    flow = new LegendFlow(limit, size);
    const title = most > 0 && panel.title ? cutWords(panel.title, size, limit) : "";
    if (title) flow.add({ kind: "none" }, title, null, AFTER_TITLE);
  }
  const lines = flow.placed.length ? flow.lines : 0;
  const height = AROUND + LINE * size * lines;
  const draw = (surface, palette, x, bottom) => {
    for (const { at, sample, text, colour } of flow.placed) {
      const middle = bottom - height + AROUND / 2 + LINE * size * (at.line - 0.5);
      drawSample(surface, palette, sample, x + at.x, middle);
      const ink = colour === null ? palette.ink : palette.word(colour);
      surface.words(text, x + at.x + sampleWidth(sample), middle, { colour: ink, size });
    }
  };
  return { height, lines, whole, draw };
}

function drawSample(surface, palette, sample, x, y) {
  const colour = sample.colour ? palette.line(sample.colour) : palette.ink;
  switch (sample.kind) {
    case "line": {
      const { width, stroke } = sample;
      surface.line([x, y, x + SAMPLE, y], { colour, width, dash: dashesOf(stroke, width) });
      break;
    }
    case "dots":
      surface.dots([x + SYMBOL_HALF, y], { colour, radius: sample.width });
      break;
    case "symbol":
      drawSymbol(surface, sample, x + SYMBOL_HALF, y, colour, palette.paper);
      break;
    case "fills":
      drawSquares(surface, palette, x, y, sample.colours.map(palette.fill));
      break;
    case "veils": {
      const seen = (one) => mixColours(palette.paper, palette.line(one.colour), one.opacity);
      drawSquares(surface, palette, x, y, sample.colours.map(seen));
      break;
    }
    default:
  }
}

/** Squares side by side, with an outline around all, as the palest ones are nearly the ground. */
function drawSquares(surface, palette, x, y, colours) {
  const top = y - 0.5 * SQUARE;
  colours.forEach((colour, i) => surface.rectangles([x + SQUARE * i, top, SQUARE, SQUARE], colour));
  const [right, bottom] = [x + SQUARE * colours.length, top + SQUARE];
  const outline = [x, top, right, top, right, bottom, x, bottom, x, top, right, top];
  surface.line(outline, { colour: palette.ink, width: OUTLINE });
}
