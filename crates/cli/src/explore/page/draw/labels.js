/**
 * Where names of points and notes stand: where they cover neither each other nor the curves, as near as that
 * allows.
 */

/** Gaps between a point and its name that are tried. */
const GAPS = [6, 16, 28, 42, 60, 82];
/** Directions that are tried, the most usual first. */
const DIRECTIONS = [
  [0, -1],
  [0, 1],
  [0.7, -0.7],
  [-0.7, -0.7],
  [0.7, 0.7],
  [-0.7, 0.7],
  [1, 0],
  [-1, 0],
  [0.4, -0.9],
  [-0.4, -0.9],
  [0.4, 0.9],
  [-0.4, 0.9],
  [0.9, -0.4],
  [-0.9, -0.4],
  [0.9, 0.4],
  [-0.9, 0.4],
];
/**
 * Prices of covering another name, leaving the frame, covering a point, a tie across something, and a stretch
 * of curve.
 */
const NAME = 1000;
const FRAME = 1000;
const POINT = 200;
const TIE = 400;
const CURVE = 12;
/** Price of a pixel of distance, and of being later in the list of directions. */
const FAR = 0.25;
const UNUSUAL = 0.05;
/** Half the size of a symbol. */
const SYMBOL = 5;
/** Side of the squares in which curves are noted. */
const SQUARE = 2.5;

/** Notes where curves are, and counts how much of them a rectangle covers. */
export class CoveredPlaces {
  constructor(frame) {
    Object.assign(this, { frame });
    this.across = Math.ceil(frame.width / SQUARE) + 1;
    this.down = Math.ceil(frame.height / SQUARE) + 1;
    this.taken = new Uint8Array(this.across * this.down);
    this.sums = null;
  }

  note(x, y) {
    const i = Math.floor((x - this.frame.x) / SQUARE);
    const j = Math.floor((y - this.frame.y) / SQUARE);
    if (i >= 0 && j >= 0 && i < this.across && j < this.down) this.taken[i + this.across * j] = 1;
  }

  /** Notes a line, or dots, given as places x, y. */
  add(xy, dots = false) {
    this.sums = null;
    for (let i = 0; i < xy.length; i += 2) {
      const [x, y] = [xy[i], xy[i + 1]];
      const [x0, y0] = i > 0 && !dots ? [xy[i - 2], xy[i - 1]] : [x, y];
      if (x !== x) continue;
      const pieces = x0 === x0 ? Math.ceil(Math.hypot(x - x0, y - y0) / SQUARE) : 0;
      for (let k = 0; k < pieces; k++) this.note(x0 + (k / pieces) * (x - x0), y0 + (k / pieces) * (y - y0));
      this.note(x, y);
    }
  }

  /** How many squares with curves a rectangle covers. */
  count({ x, y, halfX, halfY }) {
    const { across, down, frame } = this;
    this.sums ??= this.summed();
    const within = (at, most) => Math.min(most, Math.max(0, at));
    const [i0, i1] = [x - halfX, x + halfX].map((at) => within(Math.floor((at - frame.x) / SQUARE), across));
    const [j0, j1] = [y - halfY, y + halfY].map((at) => within(Math.floor((at - frame.y) / SQUARE), down));
    const [right, bottom] = [Math.min(across, i1 + 1), Math.min(down, j1 + 1)];
    const sum = (i, j) => this.sums[i + (across + 1) * j];
    return sum(right, bottom) - sum(i0, bottom) - sum(right, j0) + sum(i0, j0);
  }

  /** Whether a curve passes a place. */
  near(x, y) {
    return this.count({ x, y, halfX: 1, halfY: 1 }) > 0;
  }

  summed() {
    const { across, down, taken } = this;
    const sums = new Int32Array((across + 1) * (down + 1));
    for (let j = 0; j < down; j++) {
      let row = 0;
      for (let i = 0; i < across; i++) {
        row += taken[i + across * j];
        sums[i + 1 + (across + 1) * (j + 1)] = sums[i + 1 + (across + 1) * j] + row;
      }
    }
    return sums;
  }
}

function meet(a, b) {
  return Math.abs(a.x - b.x) < a.halfX + b.halfX && Math.abs(a.y - b.y) < a.halfY + b.halfY;
}

/** How much of a rectangle lies outside of the frame. */
function leaves(box, frame) {
  return (
    box.x - box.halfX < frame.x ||
    box.x + box.halfX > frame.right ||
    box.y - box.halfY < frame.y ||
    box.y + box.halfY > frame.bottom
  );
}

function movedInside(box, frame) {
  const inside = (at, half, low, high) =>
    high - low < 2 * half ? 0.5 * (low + high) : Math.min(high - half, Math.max(low + half, at));
  return {
    ...box,
    x: inside(box.x, box.halfX, frame.x, frame.right),
    y: inside(box.y, box.halfY, frame.y, frame.bottom),
  };
}

/** Whether a line crosses a rectangle. */
function crossesBox([ax, ay, bx, by], { x, y, halfX, halfY }) {
  const [dx, dy] = [bx - ax, by - ay];
  let [from, to] = [0, 1];
  for (const [rate, room] of [
    [-dx, ax - x + halfX],
    [dx, x + halfX - ax],
    [-dy, ay - y + halfY],
    [dy, y + halfY - ay],
  ]) {
    if (rate === 0) {
      if (room < 0) return false;
    } else if (rate < 0) from = Math.max(from, room / rate);
    else to = Math.min(to, room / rate);
  }
  return from < to;
}

function linesCross([ax, ay, bx, by], [cx, cy, dx, dy]) {
  const side = (x0, y0, x1, y1, x, y) => (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0);
  return (
    side(ax, ay, bx, by, cx, cy) * side(ax, ay, bx, by, dx, dy) < 0 &&
    side(cx, cy, dx, dy, ax, ay) * side(cx, cy, dx, dy, bx, by) < 0
  );
}

function nameCandidates({ x, y, halfX, halfY, preferred }) {
  const candidates = preferred ? [{ x: x + preferred[0], y: y + preferred[1], halfX, halfY }] : [];
  for (const gap of GAPS) {
    for (const [dx, dy] of DIRECTIONS) {
      candidates.push({
        x: x + dx * gap + Math.sign(dx) * halfX,
        y: y + dy * gap + Math.sign(dy) * halfY,
        halfX,
        halfY,
      });
    }
  }
  return candidates;
}

/**
 * Places the names of points.
 *
 * @param {{x: number, y: number, halfX: number, halfY: number, preferred?: [number, number]}[]} names points
 *   with half the size of their names, 0 for none, and the offset at which one stands if it can
 * @param {CoveredPlaces} curves
 * @param {{x: number, y: number, halfX: number, halfY: number}[]} words other words in the frame
 * @param {PanelFrame} frame
 * @returns {({x: number, y: number} | null)[]} the middles; null for a name that would cover another
 */
export function placeNames(names, curves, words, frame) {
  const taken = [...words];
  const ties = [];
  const symbols = names.map(({ x, y }) => ({ x, y, halfX: SYMBOL, halfY: SYMBOL }));
  return names.map((name, i) => {
    if (!name.halfX) return null;
    let [best, least] = [null, Infinity];
    const others = symbols.filter((_, j) => j !== i);
    const apart = others.filter((other) => !meet(other, symbols[i]));
    nameCandidates(name).forEach((place, number) => {
      const far = Math.hypot(place.x - name.x, place.y - name.y);
      let price = FAR * far + UNUSUAL * number;
      if (price >= least) return;
      const tie = [name.x, name.y, place.x, place.y];
      if (leaves(place, frame)) price += FRAME;
      price += CURVE * curves.count(place);
      for (const other of others) price += meet(place, other) ? POINT : 0;
      for (const other of taken)
        price += (meet(place, other) ? NAME : 0) + (crossesBox(tie, other) ? TIE : 0);
      for (const other of apart) price += crossesBox(tie, other) ? TIE : 0;
      for (const other of ties) price += crossesBox(other, place) || linesCross(other, tie) ? TIE : 0;
      if (price < least) [best, least] = [place, price];
    });
    if (!best) return null;
    const inside = movedInside(best, frame);
    if (taken.some((other) => meet(inside, other))) return null;
    taken.push(inside);
    ties.push([name.x, name.y, inside.x, inside.y]);
    return { x: inside.x, y: inside.y };
  });
}

/**
 * Places words whose middle belongs at a place: near it, not across a curve.
 *
 * @returns {{x: number, y: number, halfX: number, halfY: number} | null} null where they would cover others
 */
export function placeNote(at, points, curves, words, frame) {
  const [STEP_OUT, RINGS, BEYOND_CURVE, NEAR_STEP] = [6, 14, 400, 2];
  const start = movedInside(at, frame);
  const crossed = (x, y) => {
    const steps = Math.ceil(Math.hypot(x - start.x, y - start.y) / NEAR_STEP);
    let left = false;
    for (let i = 0; i <= steps; i++) {
      const part = steps ? i / steps : 0;
      const near = curves.near(start.x + part * (x - start.x), start.y + part * (y - start.y));
      if (!near) left = true;
      else if (left) return true;
    }
    return false;
  };
  let [best, least] = [null, Infinity];
  for (let ring = 0; ring <= RINGS; ring++) {
    for (const [dx, dy] of ring ? DIRECTIONS : [[0, 0]]) {
      const place = { ...start, x: start.x + STEP_OUT * ring * dx, y: start.y + STEP_OUT * ring * dy };
      const far = Math.hypot(place.x - start.x, place.y - start.y);
      let price = FAR * far;
      if (price >= least) continue;
      price += CURVE * curves.count(place) + (leaves(place, frame) ? FRAME : 0);
      for (const other of words) price += meet(place, other) ? NAME : 0;
      for (const { x, y } of points) price += meet(place, { x, y, halfX: 0, halfY: 0 }) ? POINT : 0;
      if (price < least && far > 0 && crossed(place.x, place.y)) price += BEYOND_CURVE;
      if (price < least) [best, least] = [place, price];
    }
  }
  return best && least < NAME ? best : null;
}
