/** The points that are pointed out with their names, and words at a place. */

import { CoveredPlaces, placeNames, placeNote } from "./labels.js";
import { coordinateOf } from "./ticks.js";
import { drawSymbol } from "./symbols.js";
import { wordsWidth } from "./words.js";

/** Room between a name and its neighbours, and around words that lines don't cross. */
const AIR = 4;
const BACKING = 2;
/** A name that begins farther than this from its point is tied to it. */
const TIED = 12;
const TIE = 0.7;
/** Breadth of bars, and half the length of the lines at their ends. */
const BAR = 1.2;
const CAP = 3.5;

/** Points in the frame with their places; `number` is that in the description. */
function shownMarks(panel, frame) {
  return panel.marks
    .map((mark, number) => ({ mark, number, ...frame.place(mark.x, mark.y) }))
    .filter(({ x, y }) => frame.holds(x, y, 0.5));
}

/** Draws the points that the curves go over. */
export function drawMarksBehind(surface, panel, frame, palette) {
  for (const { mark, x, y } of shownMarks(panel, frame)) {
    if (mark.behind) drawSymbol(surface, mark, x, y, palette.line(mark.colour), palette.paper);
  }
}

/**
 * Draws notes and points with their names.
 *
 * @param {object} surface
 * @param {object} panel
 * @param {PanelFrame} frame
 * @param {object} palette
 * @param {{xy: number[], dots: boolean}[]} drawn what is drawn of each series
 * @param {{mark?: number}} [highlight]
 */
export function drawMarks(surface, panel, frame, palette, drawn, highlight) {
  const shown = shownMarks(panel, frame);
  const named = shown.some(({ mark }) => mark.label) || panel.notes.length > 0;
  if (!shown.length && !named) return;
  const curves = new CoveredPlaces(frame);
  if (named) drawn.forEach(({ xy, dots }) => curves.add(xy, dots));
  const notes = placedNotes(panel, frame, shown, curves);
  for (const { note, place } of notes) {
    drawBacking(surface, place, palette);
    const colour = palette.word(note.colour);
    surface.words(note.text, place.x, place.y, { colour, size: frame.size, align: "middle" });
  }
  const bars = shown.flatMap(({ mark }) => barLines(mark, frame).map((bar) => ({ ...bar, mark })));
  if (named) bars.forEach(({ line }) => curves.add(line));
  const names = shown.map(({ mark, x, y }) => ({
    x,
    y,
    halfX: mark.label ? 0.5 * (wordsWidth(mark.label, frame.size) + AIR) : 0,
    halfY: 0.5 * (frame.size + AIR),
    preferred: mark.offset,
  }));
  const centres = placeNames(
    names,
    curves,
    notes.map(({ place }) => place),
    frame,
  );
  centres.forEach((centre, i) => {
    if (centre) drawTie(surface, names[i], centre, palette.line(shown[i].mark.colour));
  });
  for (const { line, caps, mark } of bars) {
    const look = { colour: palette.line(mark.colour), width: BAR };
    surface.line(line, look);
    caps.forEach((cap) => surface.line(cap, look));
  }
  for (const { mark, number, x, y } of shown) {
    if (!mark.behind) drawSymbol(surface, mark, x, y, palette.line(mark.colour), palette.paper);
    if (highlight?.mark === number) drawRing(surface, x, y, palette.ink);
  }
  centres.forEach((centre, i) => {
    if (!centre) return;
    const { mark } = shown[i];
    // Words are hard to read on a map.
    if (panel.cells) drawBacking(surface, { ...names[i], ...centre }, palette);
    const look = { colour: palette.word(mark.colour), size: frame.size, align: "middle" };
    surface.words(mark.label, centre.x, centre.y, { ...look, halo: panel.cells ? null : palette.paper });
  });
}

/** Draws a ring around a point that is pointed at. */
export function drawRing(surface, x, y, colour) {
  const ring = [];
  for (let i = 0; i <= 32; i++)
    ring.push(x + 7 * Math.cos((i * Math.PI) / 16), y + 7 * Math.sin((i * Math.PI) / 16));
  surface.line(ring, { colour, width: 1.4 });
}

function placedNotes(panel, frame, points, curves) {
  const notes = [];
  for (const note of panel.notes) {
    const at = frame.place(note.x, note.y);
    if (!frame.holds(at.x, at.y)) continue;
    const halfX = 0.5 * wordsWidth(note.text, frame.size) + BACKING;
    const box = { ...at, halfX, halfY: 0.5 * frame.size + BACKING };
    if (2 * halfX > frame.width) continue;
    const place = placeNote(
      box,
      points,
      curves,
      notes.map((other) => other.place),
      frame,
    );
    if (place) notes.push({ note, place });
  }
  return notes;
}

/** The ground behind words, within the frame. */
function drawBacking(surface, { x, y, halfX, halfY }, palette) {
  surface.rectangles([x - halfX, y - halfY, 2 * halfX, 2 * halfY], palette.paper);
}

/** The bars of a point, with short lines across at the ends that the frame does not cut off. */
function barLines(mark, frame) {
  const lines = [];
  const { x: alongX, y: alongY } = mark.bars ?? {};
  const at = frame.place(mark.x, mark.y);
  const cut = (value, low, high) => Math.min(high, Math.max(low, Number.isNaN(value) ? low : value));
  if (alongX) {
    const ends = alongX.map((end) => frame.across(coordinateOf(frame.scales.x, end)));
    const [a, b] = ends.map((end) => cut(end, frame.x, frame.right));
    const caps = ends.filter((end) => end >= frame.x && end <= frame.right);
    lines.push({ line: [a, at.y, b, at.y], caps: caps.map((x) => [x, at.y - CAP, x, at.y + CAP]) });
  }
  if (alongY) {
    const ends = alongY.map((end) => frame.upward(coordinateOf(frame.scales.y, end)));
    const [a, b] = ends.map((end) => (Number.isNaN(end) ? frame.bottom : cut(end, frame.y, frame.bottom)));
    const caps = ends.filter((end) => end >= frame.y && end <= frame.bottom);
    lines.push({ line: [at.x, a, at.x, b], caps: caps.map((y) => [at.x - CAP, y, at.x + CAP, y]) });
  }
  return lines;
}

/** Ties a name that stands far off to its point, up to its edge. */
function drawTie(surface, { x, y, halfX, halfY }, centre, colour) {
  const [dx, dy] = [centre.x - x, centre.y - y];
  const part = Math.max(0, 1 - Math.min(halfX / Math.abs(dx), halfY / Math.abs(dy)));
  if (Math.hypot(part * dx, part * dy) <= TIED) return;
  surface.line([x, y, x + part * dx, y + part * dy], { colour, width: TIE });
}
