/**
 * Surfaces on which pictures are drawn by the same calls: the canvas that is seen, and the SVG that is
 * exported.
 */

import { PICTURE_FONT, SCRIPT_LOWER, SCRIPT_RAISE, SCRIPT_SIZE, splitSymbols, wordsWidth } from "./words.js";
import { draw } from "./draw.js";
import { parseColour } from "./palette.js";

/** Letters are centred across their line by half of the height of small ones, as a part of their size. */
const MIDDLE = 0.35;
/**
 * A path with more corners than this is stroked in pieces and without rounded corners, as one path is slow.
 */
const PIECE = 500;
/**
 * More dots than this are painted as one picture, each at one of so many places within a pixel, across and
 * down.
 */
const STAMPED = 1000;
const FINE = 4;

/** A canvas that is not shown. */
function emptyCanvas(width, height) {
  if (typeof OffscreenCanvas !== "undefined") return new OffscreenCanvas(width, height);
  return Object.assign(document.createElement("canvas"), { width, height });
}

/** How much a dot covers of the pixels around it, 0 to 255, for its places within a pixel. */
function dotMasks(radius) {
  const side = 2 * Math.ceil(radius) + 1;
  const middle = (side - 1) / 2;
  const masks = [];
  for (let place = 0; place < FINE * FINE; place++) {
    const x = middle + ((place % FINE) + 0.5) / FINE;
    const y = middle + (Math.floor(place / FINE) + 0.5) / FINE;
    const mask = new Uint8Array(side * side);
    for (let k = 0; k < mask.length; k++) {
      const away = Math.hypot((k % side) + 0.5 - x, Math.floor(k / side) + 0.5 - y);
      mask[k] = Math.round(255 * Math.min(1, Math.max(0, radius - away + 0.5)));
    }
    masks.push(mask);
  }
  return { side, masks };
}

/** How far a part of words stands below the line. */
function below(level, size) {
  if (level === 0) return 0;
  return level < 0 ? SCRIPT_LOWER * size : -SCRIPT_RAISE * size;
}

/**
 * A canvas element as a surface. All lengths are CSS pixels; places are flat lists x, y, x, y, in which a NaN
 * begins a new piece.
 */
export class CanvasSurface {
  /**
   * Sizes the canvas for the screen's pixels. Its style must show it in that width and height.
   *
   * @param {HTMLCanvasElement | OffscreenCanvas} canvas
   * @param {{width: number, height: number, ratio?: number}} view `ratio`: pixels of the canvas per CSS pixel
   */
  constructor(canvas, { width, height, ratio = globalThis.devicePixelRatio || 1 }) {
    Object.assign(this, { canvas, width, height, ratio });
    const [across, down] = [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
    if (canvas.width !== across) canvas.width = across;
    if (canvas.height !== down) canvas.height = down;
    // Drawn by the processor: pictures are small and drawn anew as a whole, which takes a slow graphics card longer.
    this.context = canvas.getContext("2d", { willReadFrequently: true });
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  /** Fills all with a colour; with none, empties it. */
  clear(colour) {
    this.context.clearRect(0, 0, this.width, this.height);
    if (colour) this.rectangles([0, 0, this.width, this.height], colour);
  }

  /** Calls `inner`, of whose drawing only what lies in the rectangle is seen. */
  clipped(x, y, width, height, inner) {
    this.context.save();
    this.context.beginPath();
    this.context.rect(x, y, width, height);
    this.context.clip();
    inner();
    this.context.restore();
  }

  /**
   * Draws a line through places.
   *
   * @param {ArrayLike<number>} xy
   * @param {{colour: string, width: number, dash?: number[], opacity?: number, round?: boolean}} look
   */
  line(xy, { colour, width, dash = [], opacity = 1, round = false }) {
    const { context } = this;
    context.save();
    Object.assign(context, { strokeStyle: colour, lineWidth: width, globalAlpha: opacity });
    Object.assign(context, { lineCap: round ? "round" : "butt" });
    context.lineJoin = xy.length > 2 * PIECE ? "bevel" : "round";
    context.setLineDash(dash);
    // Overlapping pieces would show where a line is seen through, and a dash would begin anew.
    const most = dash.length || opacity < 1 ? Infinity : PIECE;
    this.trace(xy, most);
    context.stroke();
    context.restore();
  }

  /** Makes a path, broken where a number is missing; strokes it after so many points each, and begins anew. */
  trace(xy, most = Infinity) {
    const { context } = this;
    let [open, count] = [false, 0];
    context.beginPath();
    for (let i = 0; i + 1 < xy.length; i += 2) {
      const [x, y] = [xy[i], xy[i + 1]];
      if (!(x === x && y === y)) {
        open = false;
        continue;
      }
      if (open) context.lineTo(x, y);
      else context.moveTo(x, y);
      open = true;
      if (++count >= most) {
        context.stroke();
        context.beginPath();
        context.moveTo(x, y);
        count = 0;
      }
    }
  }

  /** Fills the areas with these corners. */
  area(xy, { colour, opacity = 1 }) {
    const { context } = this;
    context.save();
    Object.assign(context, { fillStyle: colour, globalAlpha: opacity });
    this.trace(xy);
    context.fill();
    context.restore();
  }

  /** Fills upright rectangles without seams between neighbours; `list` is x, y, width, height of each. */
  rectangles(list, colour) {
    const { context, ratio } = this;
    context.fillStyle = colour;
    const whole = (x) => Math.round(x * ratio) / ratio;
    for (let i = 0; i + 3 < list.length; i += 4) {
      const [x, y] = [whole(list[i]), whole(list[i + 1])];
      context.fillRect(x, y, whole(list[i] + list[i + 2]) - x, whole(list[i + 1] + list[i + 3]) - y);
    }
  }

  /** Draws full circles around places. */
  dots(xy, { colour, radius }) {
    const { context } = this;
    if (xy.length > 2 * STAMPED) {
      this.stamp(xy, colour, radius);
      return;
    }
    context.fillStyle = colour;
    context.beginPath();
    for (let i = 0; i + 1 < xy.length; i += 2) {
      context.moveTo(xy[i] + radius, xy[i + 1]);
      context.arc(xy[i], xy[i + 1], radius, 0, 2 * Math.PI);
    }
    context.fill();
  }

  /** Many dots at once: their coverage is computed, and painted as one picture. */
  stamp(xy, colour, radius) {
    const { ratio } = this;
    const across = this.canvas.width;
    const down = this.canvas.height;
    const cover = new Uint8Array(across * down);
    const { side, masks } = dotMasks(radius * ratio);
    const half = (side - 1) / 2;
    for (let i = 0; i + 1 < xy.length; i += 2) {
      const x = ratio * xy[i] - half;
      const y = ratio * xy[i + 1] - half;
      const left = Math.floor(x);
      const top = Math.floor(y);
      if (!(left >= 0 && top >= 0 && left + side <= across && top + side <= down)) continue;
      const mask = masks[Math.floor(FINE * (x - left)) + FINE * Math.floor(FINE * (y - top))];
      for (let row = 0, k = 0; row < side; row++) {
        let at = left + across * (top + row);
        for (let column = 0; column < side; column++, k++, at++) {
          if (mask[k] > cover[at]) cover[at] = mask[k];
        }
      }
    }
    const [red, green, blue] = parseColour(colour);
    const image = new ImageData(across, down);
    // In the order of bytes that all machines of today have.
    const pixels = new Uint32Array(image.data.buffer);
    const full = red | (green << 8) | (blue << 16);
    for (let i = 0; i < cover.length; i++) if (cover[i]) pixels[i] = (full | (cover[i] << 24)) >>> 0;
    const sheet = emptyCanvas(across, down);
    sheet.getContext("2d").putImageData(image, 0, 0);
    this.context.drawImage(sheet, 0, 0, this.width, this.height);
  }

  /**
   * Writes a text, centred across its line.
   *
   * @param {string} text
   * @param {number} x
   * @param {number} y
   * @param {{colour: string, size: number, align?: "left" | "middle" | "right", upwards?: boolean, strong?:
   *   boolean, halo?: string}} look `halo` is the colour of an edge around the letters
   */
  words(text, x, y, { colour, size, align = "left", upwards = false, strong = false, halo = null }) {
    const { context } = this;
    const before = { left: 0, middle: 0.5, right: 1 }[align];
    context.save();
    context.translate(x, y);
    if (upwards) context.rotate(-Math.PI / 2);
    Object.assign(context, { fillStyle: colour, textBaseline: "alphabetic", textAlign: "left" });
    if (halo) Object.assign(context, { strokeStyle: halo, lineWidth: 3, lineJoin: "round" });
    let at = -before * wordsWidth(text, size);
    for (const part of splitSymbols(text)) {
      context.font = `${strong ? "600 " : ""}${part.level ? SCRIPT_SIZE * size : size}px ${PICTURE_FONT}`;
      const down = MIDDLE * size + below(part.level, size);
      if (halo) context.strokeText(part.text, at, down);
      context.fillText(part.text, at, down);
      at += context.measureText(part.text).width;
    }
    context.restore();
  }
}

/** In the language of SVG. */
function escaped(text) {
  const names = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" };
  // Control characters are not allowed in XML at all.
  return String(text)
    .replace(/[\u0000-\u0008\u000b\u000c\u000e-\u001f\ufffe\uffff]/g, "")
    .replace(/[&<>"]/g, (letter) => names[letter]);
}

/** Tenths of a pixel are fine enough, and files are half as long. */
function tenth(x) {
  return Math.round(10 * x) / 10 || 0;
}

/** A standalone SVG as a surface, with the calls of {@link CanvasSurface}; `text()` gives it. */
export class SvgSurface {
  constructor({ width, height }) {
    Object.assign(this, { width, height, elements: [], clips: 0, ratio: 1 });
  }

  clear(colour) {
    this.elements.length = 0;
    if (colour) this.rectangles([0, 0, this.width, this.height], colour);
  }

  clipped(x, y, width, height, inner) {
    const name = `twinslip-frame-${++this.clips}`;
    const place = `x="${tenth(x)}" y="${tenth(y)}" width="${tenth(width)}" height="${tenth(height)}"`;
    this.elements.push(`<clipPath id="${name}"><rect ${place}/></clipPath>`, `<g clip-path="url(#${name})">`);
    inner();
    this.elements.push("</g>");
  }

  line(xy, { colour, width, dash = [], opacity = 1, round = false }) {
    const path = this.path(xy, "");
    if (!path) return;
    const dashes = dash.length ? ` stroke-dasharray="${dash.map(tenth).join(" ")}"` : "";
    const seen = opacity < 1 ? ` stroke-opacity="${opacity}"` : "";
    const cap = round ? ` stroke-linecap="round"` : "";
    this.elements.push(
      `<path fill="none" stroke="${escaped(colour)}" stroke-width="${Math.round(100 * width) / 100}"` +
        ` stroke-linejoin="round"${cap}${dashes}${seen} d="${path}"/>`,
    );
  }

  area(xy, { colour, opacity = 1 }) {
    const path = this.path(xy, "z");
    const seen = opacity < 1 ? ` fill-opacity="${opacity}"` : "";
    if (path) this.elements.push(`<path fill="${escaped(colour)}"${seen} d="${path}"/>`);
  }

  rectangles(list, colour) {
    const paths = [];
    for (let i = 0; i + 3 < list.length; i += 4) {
      const [left, top] = [tenth(list[i]), tenth(list[i + 1])];
      const across = tenth(tenth(list[i] + list[i + 2]) - left);
      const down = tenth(tenth(list[i + 1] + list[i + 3]) - top);
      paths.push(`M${left} ${top}h${across}v${down}h${-across}z`);
    }
    if (!paths.length) return;
    this.elements.push(
      `<path fill="${escaped(colour)}" shape-rendering="crispEdges" d="${paths.join("")}"/>`,
    );
  }

  dots(xy, { colour, radius }) {
    const paths = [];
    for (let i = 0; i + 1 < xy.length; i += 2) paths.push(`M${tenth(xy[i])} ${tenth(xy[i + 1])}h0`);
    if (!paths.length) return;
    this.elements.push(
      `<path fill="none" stroke="${escaped(colour)}" stroke-width="${tenth(2 * radius)}"` +
        ` stroke-linecap="round" d="${paths.join("")}"/>`,
    );
  }

  words(text, x, y, { colour, size, align = "left", upwards = false, strong = false, halo = null }) {
    const anchor = { left: "start", middle: "middle", right: "end" }[align];
    const turned = upwards ? ` transform="rotate(-90 ${tenth(x)} ${tenth(y)})"` : "";
    const weight = strong ? ` font-weight="600"` : "";
    const edge = halo
      ? ` paint-order="stroke" stroke="${escaped(halo)}" stroke-width="3" stroke-linejoin="round"`
      : "";
    let level = 0;
    const parts = splitSymbols(text).map((part) => {
      const shift = tenth(below(part.level, size) - below(level, size));
      level = part.level;
      const small = level ? ` font-size="${tenth(SCRIPT_SIZE * size)}"` : "";
      return small || shift
        ? `<tspan${small} dy="${shift}">${escaped(part.text)}</tspan>`
        : escaped(part.text);
    });
    this.elements.push(
      `<text x="${tenth(x)}" y="${tenth(y + MIDDLE * size)}" font-size="${size}"${weight}` +
        ` fill="${escaped(colour)}" text-anchor="${anchor}"${edge}${turned}>${parts.join("")}</text>`,
    );
  }

  /** Corners in the language of paths, in steps from corner to corner. */
  path(xy, end) {
    const steps = [];
    let [open, x0, y0] = [false, 0, 0];
    for (let i = 0; i + 1 < xy.length; i += 2) {
      if (!(Number.isFinite(xy[i]) && Number.isFinite(xy[i + 1]))) {
        if (open) steps.push(end);
        open = false;
        continue;
      }
      const [x, y] = [tenth(xy[i]), tenth(xy[i + 1])];
      if (open) steps.push(`l${tenth(x - x0)} ${tenth(y - y0)}`);
      else steps.push(`M${x} ${y}`);
      [open, x0, y0] = [true, x, y];
    }
    if (open) steps.push(end);
    return steps.join("");
  }

  /** Returns the SVG of all that was drawn. */
  text() {
    const [width, height] = [tenth(this.width), tenth(this.height)];
    const size = `width="${width}" height="${height}" viewBox="0 0 ${width} ${height}"`;
    const font = `font-family="${escaped(PICTURE_FONT)}" xml:space="preserve"`;
    const elements = this.elements.join("\n");
    return `<svg xmlns="http://www.w3.org/2000/svg" ${size} ${font}>\n${elements}\n</svg>\n`;
  }
}

/**
 * Returns the text of a standalone SVG of what `draw` draws.
 *
 * @param {object} description a picture or a panel of one
 * @param {object} view as of {@link draw}
 * @returns {string}
 */
export function svgOf(description, view) {
  const surface = new SvgSurface(view);
  draw(surface, description, view);
  return surface.text();
}

/**
 * Returns what a canvas shows as a PNG.
 *
 * @param {HTMLCanvasElement} canvas
 * @returns {Promise<Blob>}
 */
export function pngOf(canvas) {
  if (canvas.convertToBlob) return canvas.convertToBlob({ type: "image/png" });
  return new Promise((resolve, reject) => {
    canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("the canvas is empty"))), "image/png");
  });
}
