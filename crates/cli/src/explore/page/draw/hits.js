/** What lies under a place of a drawn picture. */

import { firstNotBelow, seriesCoordinates } from "./curves.js";

/** A mark this near is meant, even if a curve is nearer. */
const MARK_REACH = 9;

/** The answers to a pointer over a picture. */
export class Hits {
  /** @param {{panel: object, frame: PanelFrame}[]} panels in the order of the description */
  constructor(panels) {
    this.panels = panels.map(({ panel, frame }) => ({ panel, frame }));
    /** The rectangles inside the frames of the panels. */
    this.frames = panels.map(({ frame: { x, y, width, height } }) => ({ x, y, width, height }));
  }

  /**
   * Returns the number of the panel whose frame holds a place, or that of the nearest one; -1 without panels.
   */
  panelAt(px, py) {
    const away = this.frames.map(({ x, y, width, height }) =>
      Math.hypot(Math.max(x - px, 0, px - x - width), Math.max(y - py, 0, py - y - height)),
    );
    return away.indexOf(Math.min(...away));
  }

  /** Returns the ranges that a panel shows. */
  ranges(panel = 0) {
    const { frame } = this.panels[panel];
    const [from, to] = [frame.values(frame.x, frame.bottom), frame.values(frame.right, frame.y)];
    return { x: [from.x, to.x], y: [from.y, to.y] };
  }

  /**
   * Returns the values at a place, on the axes of the panel there or of the one given; `inside` says whether
   * its frame holds the place.
   *
   * @returns {{x: number, y: number, panel: number, inside: boolean} | null}
   */
  toData(px, py, panel = this.panelAt(px, py)) {
    const frame = this.panels[panel]?.frame;
    return frame ? { ...frame.values(px, py), panel, inside: frame.holds(px, py) } : null;
  }

  /**
   * Returns where values are drawn; not finite for values that are not, as zero on a logarithmic axis.
   *
   * @returns {{x: number, y: number}}
   */
  toPixel(x, y, panel = 0) {
    return this.panels[panel].frame.place(x, y);
  }

  /**
   * Returns the mark or the point of a series that is nearest to a place: of lines the nearer end of the
   * nearest stretch. A mark close by goes before curves.
   *
   * @param {number} px
   * @param {number} py
   * @param {number} [within] so many pixels
   * @param {{panel?: number, series?: (number: number) => boolean, marks?: boolean}} [of] only in this panel,
   *   only of these series, without marks
   * @returns {{panel: number, series: number | null, mark: number | null, index: number, label: string,
   *   distance: number, x: number, y: number, px: number, py: number} | null} `series` and `index`, or
   *   `mark`, are numbers in the description
   */
  nearest(
    px,
    py,
    within = Infinity,
    { panel = this.panelAt(px, py), series = () => true, marks = true } = {},
  ) {
    const found = this.panels[panel];
    if (!found || !found.frame.holds(px, py, within)) return null;
    const mark = marks ? this.nearestMark(px, py, Math.min(within, MARK_REACH), panel) : null;
    if (mark) return mark;
    let best = null;
    let least = within * within;
    found.panel.series.forEach((one, number) => {
      const hit = series(number) ? nearestOf(one, found.frame, px, py, least) : null;
      if (!hit) return;
      least = hit.square;
      best = { number, index: hit.index };
    });
    if (!best) return null;
    const { number, index } = best;
    const { x: xs, y: ys, label } = found.panel.series[number];
    const at = found.frame.place(xs[index], ys[index]);
    const values = { x: xs[index], y: ys[index], px: at.x, py: at.y };
    return { panel, series: number, mark: null, index, label, distance: Math.sqrt(least), ...values };
  }

  /** Returns the mark that is nearest to a place, as {@link Hits.nearest}. */
  nearestMark(px, py, within = Infinity, panel = this.panelAt(px, py)) {
    const found = this.panels[panel];
    let best = null;
    found?.panel.marks.forEach(({ x, y, label }, mark) => {
      const at = found.frame.place(x, y);
      const distance = Math.hypot(at.x - px, at.y - py);
      if (distance <= (best?.distance ?? within) && found.frame.holds(at.x, at.y, 1)) {
        best = { panel, series: null, mark, index: -1, label, distance, x, y, px: at.x, py: at.y };
      }
    });
    return best;
  }
}

/** The nearest point of one series, if its squared distance is less than `least`. */
function nearestOf(series, frame, px, py, least) {
  const { x, y, sorted } = seriesCoordinates(series, frame.scales);
  const { perX, perY, scales } = frame;
  // In pixels from the place asked for.
  const x0 = frame.x - scales.x.lo * perX - px;
  const y0 = frame.bottom + scales.y.lo * perY - py;
  let index = -1;
  const visit = (i) => {
    const [bx, by] = [x0 + perX * x[i], y0 - perY * y[i]];
    if (by !== by) return;
    let [cx, cy, nearer] = [bx, by, i];
    if (!series.dots && i > 0 && y[i - 1] === y[i - 1]) {
      const [ax, ay] = [x0 + perX * x[i - 1], y0 - perY * y[i - 1]];
      const [dx, dy] = [bx - ax, by - ay];
      const length = dx * dx + dy * dy;
      const part = length > 0 ? Math.min(1, Math.max(0, -(ax * dx + ay * dy) / length)) : 1;
      [cx, cy] = [ax + part * dx, ay + part * dy];
      if (part < 0.5) nearer = i - 1;
    }
    const square = cx * cx + cy * cy;
    if (square < least) [least, index] = [square, nearer];
  };
  if (!sorted) {
    for (let i = 0; i < x.length; i++) visit(i);
    return index < 0 ? null : { index, square: least };
  }
  // Outwards from the place, until the abscissa alone is farther than the best.
  const middle = firstNotBelow(x, scales.x.lo + (px - frame.x) / perX);
  for (let i = middle; i < x.length; i++) {
    const before = i > 0 ? x0 + perX * x[i - 1] : -Infinity;
    if (before > 0 && before * before >= least) break;
    visit(i);
  }
  for (let i = middle - 1; i >= 0; i--) {
    const across = x0 + perX * x[i];
    if (across * across >= least) break;
    visit(i);
  }
  return index < 0 ? null : { index, square: least };
}
