/** The frame of a panel: where values are drawn, the grid, ticks and names of the axes. */

import { coordinateOf, ticksOf, valueAt } from "./ticks.js";
import { wordsWidth } from "./words.js";

/** Lengths of ticks with a label and without. */
const TICK = 4;
const SMALL_TICK = 2.5;
/** Room between the frame and the labels of ticks. */
const AIR = 7;
/**
 * Least room between labels side by side, and least distance of those one below the other, in sizes of
 * letters.
 */
const BESIDE = 9;
const BELOW = 1.35;
/** Breadths of the frame, of grid lines and of the line at zero. */
const BORDER = 0.9;
const GRID_LINE = 0.8;
const ZERO_LINE = 0.7;
/** From line to line, in sizes of letters. */
const LINE = 1.35;

/** Returns the ticks of a horizontal axis of that width. */
export function horizontalTicks(scale, width, size) {
  return ticksOf(scale, width, (ticks) =>
    ticks.every((tick, i) => {
      if (i === 0) return true;
      const apart = ((tick.at - ticks[i - 1].at) / (scale.hi - scale.lo)) * width;
      return apart >= 0.5 * (wordsWidth(tick.label, size) + wordsWidth(ticks[i - 1].label, size)) + BESIDE;
    }),
  );
}

/** Returns those of a vertical one of that height. */
export function verticalTicks(scale, height, size) {
  return ticksOf(scale, height, (ticks) =>
    ticks.every(
      (tick, i) => i === 0 || ((tick.at - ticks[i - 1].at) / (scale.hi - scale.lo)) * height >= BELOW * size,
    ),
  );
}

/** Returns the width of the widest label. */
export function widestLabel(ticks, size) {
  return ticks.named.reduce((widest, tick) => Math.max(widest, wordsWidth(tick.label, size)), 0);
}

/** Returns the room that the labels of ticks and a name of so many lines need below the frame. */
export function roomBelow(lines, size) {
  return AIR + size + (lines > 0 ? 2 + LINE * size * lines : 0) + 4;
}

/** Returns the room that they need beside it. */
export function roomBeside(lines, widest, size) {
  return 4 + LINE * size * lines + (lines > 0 ? 5 : 0) + widest + AIR;
}

/** A frame with its scales; pixels are those of the surface. */
export class PanelFrame {
  /**
   * @param {{x: number, y: number, width: number, height: number}} box its inside
   * @param {{x: Scale, y: Scale}} scales
   * @param {{x: object, y: object}} ticks
   * @param {number} size of letters
   */
  constructor(box, scales, ticks, size) {
    Object.assign(this, box, { scales, ticks, size });
    this.right = this.x + this.width;
    this.bottom = this.y + this.height;
    this.perX = this.width / (scales.x.hi - scales.x.lo);
    this.perY = this.height / (scales.y.hi - scales.y.lo);
  }

  /** Where a coordinate of the horizontal axis is drawn. */
  across(coordinate) {
    return this.x + (coordinate - this.scales.x.lo) * this.perX;
  }

  /** Where one of the vertical axis is. */
  upward(coordinate) {
    return this.bottom - (coordinate - this.scales.y.lo) * this.perY;
  }

  /** The place of a pair of values; not finite if it cannot be drawn. */
  place(x, y) {
    const { scales } = this;
    return { x: this.across(coordinateOf(scales.x, x)), y: this.upward(coordinateOf(scales.y, y)) };
  }

  /** The values at a place. */
  values(px, py) {
    const { scales } = this;
    return {
      x: valueAt(scales.x, scales.x.lo + (px - this.x) / this.perX),
      y: valueAt(scales.y, scales.y.lo + (this.bottom - py) / this.perY),
    };
  }

  /** Whether a place lies inside, or so many pixels outside at most. */
  holds(px, py, more = 0) {
    return px >= this.x - more && px <= this.right + more && py >= this.y - more && py <= this.bottom + more;
  }

  /** Draws what lies behind the curves. */
  drawGrid(surface, palette, zeroLine) {
    const look = { colour: palette.grid, width: GRID_LINE };
    for (const tick of this.ticks.x.named) {
      const at = this.across(tick.at);
      surface.line([at, this.y, at, this.bottom], look);
    }
    for (const tick of this.ticks.y.named) {
      const at = this.upward(tick.at);
      surface.line([this.x, at, this.right, at], look);
    }
    const { y } = this.scales;
    if (zeroLine && !y.log && y.lo <= 0 && y.hi >= 0) {
      surface.line([this.x, this.upward(0), this.right, this.upward(0)], {
        colour: palette.ink,
        width: ZERO_LINE,
      });
    }
  }

  /** Draws the frame itself with ticks and their labels. */
  drawBorder(surface, palette) {
    const { x, y, right, bottom, size, ticks } = this;
    const look = { colour: palette.ink, width: BORDER };
    surface.line([x, y, right, y, right, bottom, x, bottom, x, y], look);
    const [below, beside] = [[], []];
    for (const [list, length] of [
      [ticks.x.named.map(({ at }) => at), TICK],
      [ticks.x.small, SMALL_TICK],
    ]) {
      for (const at of list) below.push(this.across(at), bottom, this.across(at), bottom + length, NaN, NaN);
    }
    for (const [list, length] of [
      [ticks.y.named.map(({ at }) => at), TICK],
      [ticks.y.small, SMALL_TICK],
    ]) {
      for (const at of list) beside.push(x - length, this.upward(at), x, this.upward(at), NaN, NaN);
    }
    surface.line(below, look);
    surface.line(beside, look);
    const words = { colour: palette.ink, size };
    for (const tick of ticks.x.named) {
      surface.words(tick.label, this.across(tick.at), bottom + AIR + 0.5 * size, {
        ...words,
        align: "middle",
      });
    }
    for (const tick of ticks.y.named) {
      surface.words(tick.label, x - AIR, this.upward(tick.at), { ...words, align: "right" });
    }
  }

  /**
   * Draws the names of the axes in lines: one below, the other from `left` on and between the heights of
   * `span`.
   */
  drawNames(surface, palette, names, left, span) {
    const { size } = this;
    const look = { colour: palette.ink, size, align: "middle" };
    const within = (at, half, low, high) => Math.max(low + half, Math.min(at, high - half));
    names.x.forEach((line, i) => {
      const y = this.bottom + AIR + size + 2 + LINE * size * (i + 0.5);
      const x = within(this.x + 0.5 * this.width, 0.5 * wordsWidth(line, size), 2, surface.width - 2);
      surface.words(line, x, y, look);
    });
    names.y.forEach((line, i) => {
      const y = within(this.y + 0.5 * this.height, 0.5 * wordsWidth(line, size), ...span);
      surface.words(line, left + LINE * size * (i + 0.5), y, { ...look, upwards: true });
    });
  }
}
