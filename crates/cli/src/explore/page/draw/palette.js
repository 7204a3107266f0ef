/**
 * Colours of pictures in light and dark. Descriptions carry colours chosen for white paper; on a dark ground
 * lines keep their hue and become lighter, and the pale fills of maps become dark ones.
 */

/** The theme of pictures on white, as the command line draws them. */
const LIGHT_THEME = { ink: "#282828", grid: "#e4e4e4", background: "#ffffff" };

/** Least contrast (as WCAG defines it) of lines and of words with the ground. */
const LINE_CONTRAST = 4.2;
const WORD_CONTRAST = 4.5;
/** Colours with less chroma than this are greys. */
const GREY = 0.02;
/** Colours with more chroma than this are taken for full ones by maps: only paler ones tend to the ground. */
const FULL = 0.1;
/** The lightest fills on a dark ground: of full colours, and of those that are dark on a light one. */
const LIGHTEST_FULL = 0.66;
const LIGHTEST = 0.87;

/**
 * Returns red, green and blue of a CSS colour, 0 to 255 each.
 *
 * @param {string} colour hexadecimal or rgb()
 * @returns {[number, number, number]}
 */
export function parseColour(colour) {
  const text = String(colour).trim();
  const hex = /^#([0-9a-f]{3,8})$/i.exec(text)?.[1];
  if (hex) {
    const short = hex.length < 6;
    const digits = (i) => (short ? hex[i] + hex[i] : hex.slice(2 * i, 2 * i + 2));
    return [0, 1, 2].map((i) => parseInt(digits(i), 16));
  }
  const numbers = text.match(/^rgba?\(([^)]*)\)/i)?.[1].match(/[\d.]+/g);
  if (numbers && numbers.length >= 3) return numbers.slice(0, 3).map(Number);
  if (typeof document !== "undefined") {
    // The browser knows all other notations; it keeps black for what is no colour.
    const context = document.createElement("canvas").getContext("2d");
    context.fillStyle = text;
    if (/^#/.test(context.fillStyle)) return parseColour(context.fillStyle);
  }
  return [0, 0, 0];
}

/** Red, green and blue as a hexadecimal colour. */
function formatColour(parts) {
  const pair = (x) =>
    Math.round(Math.min(255, Math.max(0, x)))
      .toString(16)
      .padStart(2, "0");
  return "#" + parts.map(pair).join("");
}

/** Returns `part` of `other` mixed into `one`, both hexadecimal. */
export function mixColours(one, other, part) {
  const [a, b] = [parseColour(one), parseColour(other)];
  return formatColour(a.map((x, i) => x + part * (b[i] - x)));
}

function linear(parts) {
  return parts.map((x) => (x / 255 <= 0.04045 ? x / 255 / 12.92 : ((x / 255 + 0.055) / 1.055) ** 2.4));
}

function encoded(parts) {
  return parts.map((x) => 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
}

function luminance(parts) {
  const [r, g, b] = linear(parts);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/** The contrast of two colours given as red, green and blue: 1 (none) to 21. */
function colourContrast(a, b) {
  const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y);
  return (high + 0.05) / (low + 0.05);
}

/** Lightness and the two opponent coordinates of OKLab, in which equal steps look equal. */
function toLab(parts) {
  const [r, g, b] = linear(parts);
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}

function fromLab([light, a, b]) {
  const l = (light + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (light - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (light - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
}

/** The colour of this lightness and hue, with as much of the chroma as a screen can show. */
function shown(light, a, b) {
  for (let part = 1; part > 0; part -= 0.05) {
    const parts = fromLab([light, part * a, part * b]);
    if (parts.every((x) => x >= -1e-4 && x <= 1.0001))
      return encoded(parts.map((x) => Math.min(1, Math.max(0, x))));
  }
  return encoded(fromLab([light, 0, 0]).map((x) => Math.min(1, Math.max(0, x))));
}

/** The colour itself, or with its lightness moved away from the ground until the contrast is enough. */
function contrasting(parts, ground, least) {
  if (colourContrast(parts, ground) >= least) return parts;
  const [light, a, b] = toLab(parts);
  const up = luminance(ground) < 0.18;
  for (let i = 1; i <= 40; i++) {
    const moved = up ? light + ((1 - light) * i) / 40 : light * (1 - i / 40);
    const made = shown(moved, a, b);
    if (colourContrast(made, ground) >= least) return made;
  }
  return up ? [255, 255, 255] : [0, 0, 0];
}

/** A fill of a map for a dark ground: white becomes the ground, full colours keep about their looks. */
function darkened(parts, ground, ink) {
  const [light, a, b] = toLab(parts);
  const [darkest] = toLab(ground);
  const chroma = Math.hypot(a, b);
  if (chroma < GREY) {
    const [lightest] = toLab(ink);
    return shown(darkest + (1 - light) * (lightest - darkest), a, b);
  }
  // Pale colours have lost chroma to white; the darker they become the more of it they need to be told apart.
  const paleness = Math.max(0, 1 - chroma / FULL) * light;
  const inverted = Math.min(LIGHTEST, darkest + (1 - light) * 0.9 + 0.12);
  const made = paleness > 0 || light > 0.8 ? inverted : Math.min(light, LIGHTEST_FULL);
  return shown(made, a * (1 + 0.5 * paleness), b * (1 + 0.5 * paleness));
}

const known = new Map();

/**
 * Prepares the colours of a theme for drawing.
 *
 * @param {{ink?: string, grid?: string, background?: string, mark?: string}} [theme] CSS colours
 * @returns {{ink: string, grid: string, paper: string, dark: boolean, line: (c: string) => string, word: (c:
 *   string) => string, fill: (c: string) => string}} `line`, `word` and `fill` give the colour that a colour
 *   of a description has in this theme.
 */
export function paletteOf(theme = {}) {
  const of = { ...LIGHT_THEME, ...theme };
  const key = `${of.ink}|${of.grid}|${of.background}`;
  const found = known.get(key);
  if (found) return found;
  const [ground, ink] = [parseColour(of.background), parseColour(of.ink)];
  const dark = luminance(ground) < 0.18;
  const remembered = (change) => {
    const made = new Map();
    return (colour) => {
      if (!made.has(colour)) made.set(colour, formatColour(change(parseColour(colour))));
      return made.get(colour);
    };
  };
  const changed = (parts, least) => {
    const [, a, b] = toLab(parts);
    // Black and the ink of descriptions are the ink of the theme.
    if (Math.hypot(a, b) < GREY && luminance(parts) < 0.05) return ink;
    return contrasting(parts, ground, least);
  };
  const palette = {
    ink: formatColour(ink),
    grid: formatColour(parseColour(of.grid)),
    paper: formatColour(ground),
    dark,
    line: remembered((parts) => changed(parts, dark ? LINE_CONTRAST : 1)),
    word: remembered((parts) => changed(parts, WORD_CONTRAST)),
    fill: remembered((parts) => (dark ? darkened(parts, ground, ink) : parts)),
  };
  if (known.size > 20) known.clear();
  known.set(key, palette);
  return palette;
}
