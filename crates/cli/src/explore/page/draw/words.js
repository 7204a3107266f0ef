/** Words of pictures: symbols with subscripts and superscripts, their widths, and lines broken to a width. */

/** The font of all pictures: that of the reader's system. */
export const PICTURE_FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', Arial, sans-serif";

/**
 * Size of raised and lowered letters, and how far these stand off the line, as parts of the size of the
 * others.
 */
export const SCRIPT_SIZE = 0.74;
export const SCRIPT_LOWER = 0.22;
export const SCRIPT_RAISE = 0.36;

const GREEK = {
  alpha: "α",
  beta: "β",
  gamma: "γ",
  delta: "δ",
  epsilon: "ε",
  zeta: "ζ",
  eta: "η",
  theta: "θ",
  kappa: "κ",
  lambda: "λ",
  mu: "μ",
  nu: "ν",
  xi: "ξ",
  pi: "π",
  rho: "ρ",
  sigma: "σ",
  tau: "τ",
  phi: "φ",
  chi: "χ",
  psi: "ψ",
  omega: "ω",
  Gamma: "Γ",
  Delta: "Δ",
  Theta: "Θ",
  Lambda: "Λ",
  Xi: "Ξ",
  Pi: "Π",
  Sigma: "Σ",
  Phi: "Φ",
  Psi: "Ψ",
  Omega: "Ω",
};
const GREEK_NAME = new RegExp(
  `(?<![\\p{L}\\p{N}_])(${Object.keys(GREEK).join("|")})(?![\\p{L}\\p{N}])`,
  "gu",
);
const RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻";
const LOWERED = "₀₁₂₃₄₅₆₇₈₉ₛ";
const PLAIN_RAISED = "0123456789−";
const PLAIN_LOWERED = "0123456789s";
const SCRIPTS = /(?<![\p{L}\p{N}_])(\p{L})_([\p{L}\p{N}]+)|([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)|([₀₁₂₃₄₅₆₇₈₉ₛ]+)/gu;

/**
 * Splits a text into parts on the line, below it and above it. A subscript is what follows a single letter
 * and an underscore, as in `V_H` and `tau_ss`; names of Greek letters become these letters.
 *
 * @param {string} text
 * @returns {{text: string, level: -1 | 0 | 1}[]}
 */
export function splitSymbols(text) {
  const written = String(text).replace(GREEK_NAME, (name) => GREEK[name]);
  const parts = [];
  const put = (part, level) => {
    const last = parts[parts.length - 1];
    if (last && last.level === level) last.text += part;
    else if (part) parts.push({ text: part, level });
  };
  const plain = (part, from, to) => [...part].map((letter) => to[from.indexOf(letter)]).join("");
  let done = 0;
  for (const found of written.matchAll(SCRIPTS)) {
    put(written.slice(done, found.index), 0);
    const [all, letter, below, raised, lowered] = found;
    if (letter) {
      put(letter, 0);
      put(below, -1);
    } else if (raised) put(plain(raised, RAISED, PLAIN_RAISED), 1);
    else put(plain(lowered, LOWERED, PLAIN_LOWERED), -1);
    done = found.index + all.length;
  }
  put(written.slice(done), 0);
  return parts;
}

let measuring;
const widths = new Map();

/** Width of letters on the line; without a browser an estimate. */
function lettersWidth(text, size) {
  if (measuring === undefined) {
    measuring = typeof document === "undefined" ? null : document.createElement("canvas").getContext("2d");
  }
  if (!measuring) return 0.57 * size * text.length;
  measuring.font = `${size}px ${PICTURE_FONT}`;
  return measuring.measureText(text).width;
}

/**
 * Returns the width of a text on one line, in pixels.
 *
 * @param {string} text
 * @param {number} size of its letters, in pixels
 */
export function wordsWidth(text, size) {
  const key = `${size} ${text}`;
  let width = widths.get(key);
  if (width === undefined) {
    const parts = splitSymbols(text);
    width = parts.reduce(
      (sum, part) => sum + lettersWidth(part.text, part.level ? SCRIPT_SIZE * size : size),
      0,
    );
    if (widths.size > 5000) widths.clear();
    widths.set(key, width);
  }
  return width;
}

/** The words of a text; a symbol and its value, as in `K = 0.14`, are one. */
function unbroken(text) {
  const words = [];
  let joined = false;
  for (const word of text.split(/\s+/).filter(Boolean)) {
    if (words.length && (word === "=" || joined)) words[words.length - 1] += " " + word;
    else words.push(word);
    joined = word === "=";
  }
  return words;
}

/**
 * Breaks a text into lines none of which is wider than `limit`: between words, and within one that is too
 * long alone.
 *
 * @returns {string[]}
 */
export function wrapWords(text, size, limit) {
  const lines = [];
  let line = "";
  for (const word of unbroken(text)) {
    const longer = line ? `${line} ${word}` : word;
    if (wordsWidth(longer, size) <= limit) {
      line = longer;
      continue;
    }
    if (line) lines.push(line);
    line = word;
    while (wordsWidth(line, size) > limit && line.length > 1) {
      let count = line.length - 1;
      while (count > 1 && wordsWidth(line.slice(0, count), size) > limit) count -= 1;
      lines.push(line.slice(0, count));
      line = line.slice(count);
    }
  }
  if (line) lines.push(line);
  return lines;
}

/** Returns the text, cut with an ellipsis if it is wider than `limit`. */
export function cutWords(text, size, limit) {
  if (wordsWidth(text, size) <= limit) return text;
  let count = text.length - 1;
  while (count > 0 && wordsWidth(text.slice(0, count).trimEnd() + "…", size) > limit) count -= 1;
  return count > 0 ? text.slice(0, count).trimEnd() + "…" : "";
}
