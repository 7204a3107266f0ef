/** Where everything stands on a picture: blocks one below the other, each with its columns of panels. */

import { horizontalTicks, PanelFrame, roomBelow, roomBeside, verticalTicks, widestLabel } from "./axes.js";
import { headingOf } from "./legend.js";
import { scaleOf } from "./ticks.js";
import { cutWords, wordsWidth, wrapWords } from "./words.js";

/** Columns narrower than this go below each other. */
const NARROWEST = 300;
/** Sizes of letters, the smaller ones on surfaces narrower and lower than these. */
const SIZES = [
  { size: 10.5, width: 250, height: 170 },
  { size: 12, width: 420, height: 0 },
  { size: 13, width: Infinity, height: Infinity },
];
/** Titles of blocks are larger by this factor, and have so much room above. */
const BLOCK_TITLE = 1.18;
const ABOVE = 10;
/** Least room at the right of a frame. */
const RIGHT = 10;
/** Room below a panel, and between it and the edge. */
const BOTTOM = 4;
/** Frames that take less than this part of the height give up the legend. */
const LOW_SHARE = 0.36;
/**
 * Frames of a picture that is as high as it likes to be are about as wide as this times their height, or
 * more.
 */
const NATURAL_LOWEST = 110;
const NATURAL_HIGHEST = 420;

/** What is left out where frames would become lower than `lowest`: the legend, names of axes, the title. */
const LEVELS = [
  { lines: Infinity, names: true, lowest: 84, share: LOW_SHARE },
  { lines: 1, names: true, lowest: 44, share: 0 },
  { lines: 1, names: false, lowest: 32, share: 0 },
  { lines: 0, names: false, lowest: 0, share: 0 },
];

/** The blocks of a description, be it a picture or one of its panels. */
function blocksOf(description) {
  return description.blocks ?? [{ title: "", columns: [[description]] }];
}

/** All panels of a description, block by block, each column by column from its top. */
function panelsOf(description) {
  return blocksOf(description).flatMap((block) => block.columns.flat());
}

function letterSize(view, columnWidth) {
  if (view.size) return view.size;
  return SIZES.find(({ width, height }) => columnWidth < width || (view.height ?? Infinity) < height).size;
}

/** A column of panels before the heights of frames are known. */
function draftColumn(panels, left, width, size, level, rangesOf, natural) {
  const names = level.names && width >= 140;
  const drafts = panels.map((panel) => {
    const ranges = rangesOf(panel) ?? {};
    const scales = { x: scaleOf(panel.x, ranges.x), y: scaleOf(panel.y, ranges.y) };
    const named = { x: Boolean(panel.x.label), y: Boolean(panel.y.label) };
    return { panel, scales, named };
  });
  let [inset, right] = [26, RIGHT];
  for (const draft of drafts) {
    const high = Math.max(60, natural ?? 200);
    draft.yName =
      names && draft.named.y ? wrapWords(draft.panel.y.label, size, high + 2.2 * size).slice(0, 2) : [];
    const ticks = draft.named.y ? verticalTicks(draft.scales.y, high, size) : { named: [] };
    inset = Math.max(inset, roomBeside(draft.yName.length, widestLabel(ticks, size), size));
    const across = draft.named.x
      ? horizontalTicks(draft.scales.x, Math.max(40, width - inset - right), size).named
      : [];
    const last = across.at(-1);
    if (last) {
      const beyond =
        ((draft.scales.x.hi - last.at) / (draft.scales.x.hi - draft.scales.x.lo)) * (width - inset - right);
      right = Math.max(right, 0.5 * wordsWidth(last.label, size) - beyond + 4);
    }
  }
  const frameWidth = Math.max(20, width - inset - right);
  for (const draft of drafts) {
    const { panel } = draft;
    draft.aside = width < 420 ? inset - 6 : 0;
    draft.heading = headingOf(panel, frameWidth + right - 4 + draft.aside, size, level.lines);
    // Numbers at the top of the axis reach up to a heading above them.
    draft.strip = draft.heading.height + (draft.aside ? 3 : 0);
    draft.xName = names && draft.named.x ? wrapWords(panel.x.label, size, width - 8) : [];
    draft.below = (draft.named.x ? roomBelow(draft.xName.length, size) : 6) + BOTTOM;
    const shape = panel.frame ? panel.frame[1] / panel.frame[0] : 0.6;
    draft.natural = Math.min(NATURAL_HIGHEST, Math.max(NATURAL_LOWEST, shape * frameWidth));
  }
  return { drafts, left, x: left + inset, frameWidth };
}

/**
 * Headings at the top of a row are equally high, and so are those of panels side by side: frames begin in one
 * line.
 */
function alignColumns(columns) {
  const strips = columns.map(({ drafts }) => drafts.map(({ strip }) => strip));
  for (const { drafts } of columns) {
    for (const other of strips) {
      const beside = other.length === drafts.length ? drafts.length : 1;
      for (let i = 0; i < Math.min(beside, drafts.length, other.length); i++) {
        drafts[i].strip = Math.max(drafts[i].strip, other[i]);
      }
    }
  }
}

/** The height of all but the frames of a column. */
function furnitureOf({ drafts }) {
  return drafts.reduce((sum, { strip, below }) => sum + strip + below, 0);
}

/** Groups of columns side by side, with titles of blocks, at one level of completeness. */
function draftRows(description, view, level) {
  const rangesOf = rangesByPanel(description, view.ranges);
  const rows = [];
  const { width } = view;
  for (const block of blocksOf(description)) {
    const columns = block.columns.filter((column) => column.length);
    const beside = Math.min(columns.length, Math.max(1, Math.floor(width / NARROWEST)));
    for (let first = 0; first < columns.length; first += beside) {
      const group = columns.slice(first, first + beside);
      const columnWidth = width / group.length;
      const size = letterSize(view, columnWidth);
      const drafts = group.map((panels, i) =>
        draftColumn(
          panels,
          i * columnWidth,
          columnWidth,
          size,
          level,
          rangesOf,
          description.blocks ? 160 : view.height,
        ),
      );
      alignColumns(drafts);
      const titleSize = BLOCK_TITLE * size;
      const title = first === 0 && block.title ? wrapWords(block.title, titleSize, width - 16) : [];
      const titleHeight = title.length ? ABOVE + 1.4 * titleSize * title.length : 0;
      const furniture = titleHeight + Math.max(...drafts.map(furnitureOf));
      const natural = Math.max(
        ...drafts.map((column) => column.drafts.reduce((sum, one) => sum + one.natural, 0)),
      );
      const panels = Math.max(...drafts.map((column) => column.drafts.length));
      rows.push({ columns: drafts, title, titleSize, titleHeight, furniture, natural, panels, size });
    }
  }
  return rows;
}

/** The ranges that replace those of each panel. */
function rangesByPanel(description, ranges) {
  const all = panelsOf(description);
  return (panel) => (Array.isArray(ranges) ? ranges[all.indexOf(panel)] : ranges);
}

function sumOf(rows, key) {
  return rows.reduce((sum, row) => sum + row[key], 0);
}

/**
 * Returns the height at which a picture or a panel looks best in a width.
 *
 * @param {object} description
 * @param {number} width in CSS pixels
 * @param {object} [view] more of the view
 */
export function pictureHeight(description, width, view = {}) {
  const rows = draftRows(description, { ...view, width, height: undefined }, LEVELS[0]);
  return Math.ceil(sumOf(rows, "furniture") + sumOf(rows, "natural") + BOTTOM);
}

/**
 * Places all panels of a description on a surface.
 *
 * @param {object} description
 * @param {object} view
 * @returns {{titles: object[], panels: {panel: object, frame: PanelFrame, heading: object, names: object,
 *   span: [number, number], left: number, aside: number}[]}} where names of vertical axes begin and between
 *   which heights they stay, and how far to the left of the frame the heading begins
 */
export function layoutOf(description, view) {
  let rows;
  let factor = 1;
  for (const level of LEVELS) {
    rows = draftRows(description, view, level);
    const [furniture, panels] = [sumOf(rows, "furniture"), sumOf(rows, "panels")];
    const free = view.height - furniture;
    factor = Math.max(free, 16 * panels) / sumOf(rows, "natural");
    if (free / panels >= Math.min(level.lowest, 0.5 * view.height) && free >= level.share * view.height)
      break;
  }
  const [titles, panels] = [[], []];
  let top = 0;
  for (const row of rows) {
    row.title.forEach((text, i) => {
      titles.push({ text, x: 8, y: top + ABOVE + 1.4 * row.titleSize * (i + 0.5), size: row.titleSize });
    });
    top += row.titleHeight;
    const room = row.furniture - row.titleHeight + row.natural * factor;
    for (const column of row.columns) {
      // A panel alone fills its surface; in a picture no frame is higher than wide.
      const most = description.blocks ? column.frameWidth : Infinity;
      const natural = column.drafts.reduce((sum, one) => sum + one.natural, 0);
      // Of several panels the last ends where that of the highest column does.
      const stretch = column.drafts.length > 1 ? (room - furnitureOf(column)) / natural : factor;
      let at = top;
      for (const draft of column.drafts) {
        const height = Math.min(most, draft.natural * Math.max(stretch, factor));
        at += draft.strip;
        panels.push(placedPanel(draft, column, at, height, row.size));
        at += height + draft.below;
      }
    }
    top += room;
  }
  return { titles, panels };
}

function placedPanel(draft, column, top, height, size) {
  const { panel, scales, named, heading, xName, yName, aside } = draft;
  const box = { x: column.x, y: top, width: column.frameWidth, height };
  const nothing = { named: [], small: [] };
  const ticks = {
    x: named.x ? horizontalTicks(scales.x, box.width, size) : nothing,
    y: named.y ? verticalTicks(scales.y, box.height, size) : nothing,
  };
  const frame = new PanelFrame(box, scales, ticks, size);
  // Beside a heading that begins at the frame there is room for a long name.
  const span = [top - (aside ? 0 : draft.strip - 4), top + height + draft.below - 4];
  const names = { x: xName, y: fittedName(panel.y.label, yName, size, span[1] - span[0]) };
  return { panel, frame, heading, names, span, left: column.left + 4, aside };
}

/** A name in its lines, without its unit or cut if these are longer than there is room for. */
function fittedName(name, lines, size, room) {
  if (lines.every((line) => wordsWidth(line, size) <= room)) return lines;
  const again = wrapWords(name, size, room);
  if (again.length <= lines.length) return again;
  const bare = name.replace(/\s*\[[^\]]*\]\s*$/, "");
  const shorter = wrapWords(bare, size, room);
  return shorter.length <= lines.length ? shorter : [cutWords(bare, size, room)];
}
