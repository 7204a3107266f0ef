// A pane: a heading, what is being computed, a drawing, words about it, and a menu of what can be taken away.

import { CanvasSurface, pngOf, svgOf } from "../draw/surface.js";
import { draw } from "../draw/draw.js";
import { commandLine, copied, csv, download, filesOf, python, toml } from "../out.js";
import { element } from "../elements.js";

let panes = 0;
/** What is out of view is drawn after so many milliseconds without anything new. */
const LATER = 700;

/** The colours of drawings, from the style of the page. */
export function themeOf(node) {
  const style = getComputedStyle(node);
  const get = (name) => style.getPropertyValue(name).trim();
  return {
    ink: get("--ink"),
    muted: get("--muted"),
    grid: get("--grid"),
    background: get("--pane"),
    accent: get("--accent"),
  };
}

export class Pane {
  /** `title` is its heading, `name` the begin of the names of its files, `height` that of the drawing in pixels. */
  constructor(app, { title, name, height = 260, drawn = true, menu = true }) {
    Object.assign(this, { app, name, title });
    const id = `pane-${(panes += 1)}`;
    this.description = null;
    this.answer = null;
    this.ranges = null;
    this.status = element("span", { class: "status", role: "status" });
    this.heading = element("h2", { id: `${id}-title` }, title);
    this.menu = menu ? this.makeMenu(id) : null;
    this.problem = element("p", { class: "problem", hidden: true });
    this.words = element("div", { class: "words" });
    this.body = element("div", { class: "body" });
    this.element = element(
      "section",
      { class: `pane pane-${name}`, "aria-labelledby": `${id}-title` },
      element("header", {}, this.heading, this.status, this.menu),
      this.body,
      this.problem,
      this.words,
    );
    if (drawn) {
      this.canvas = element("canvas", { role: "img", "aria-label": title, tabindex: "0" });
      this.canvas.style.height = `${height}px`;
      this.tip = element("div", { class: "tip", hidden: true });
      this.body.append(this.canvas, this.tip);
      new ResizeObserver(() => this.redraw()).observe(this.canvas);
      // What is not in view is drawn when it comes into view, or when nothing else has been drawn for a while.
      this.visible = true;
      const seen = new IntersectionObserver(([entry]) => {
        this.visible = entry.isIntersecting;
        if (this.visible && this.owes) this.redraw();
      });
      seen.observe(this.body);
      this.listen();
    }
  }

  makeMenu(id) {
    const list = element("ul", { id: `${id}-menu`, role: "menu", hidden: true });
    const button = element(
      "button",
      { class: "menu", "aria-haspopup": "menu", "aria-expanded": "false", "aria-controls": `${id}-menu`, title: "Take this away" },
      "⋯",
    );
    button.setAttribute("aria-label", `Take away: ${this.title}`);
    const close = () => {
      list.hidden = true;
      button.setAttribute("aria-expanded", "false");
    };
    for (const [label, act] of this.exports()) {
      const item = element("button", { role: "menuitem" }, label);
      item.addEventListener("click", () => {
        close();
        button.focus();
        act();
      });
      list.append(element("li", { role: "none" }, item));
    }
    button.addEventListener("click", () => {
      const opens = list.hidden;
      list.hidden = !opens;
      button.setAttribute("aria-expanded", String(opens));
      if (opens) list.querySelector("button").focus();
    });
    list.addEventListener("keydown", (event) => {
      const items = [...list.querySelectorAll("button")];
      const at = items.indexOf(document.activeElement);
      const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
      if (step) items[(at + step + items.length) % items.length].focus();
      else if (event.key === "Escape") {
        close();
        button.focus();
      } else return;
      event.preventDefault();
      event.stopPropagation();
    });
    list.addEventListener("focusout", (event) => {
      if (!list.contains(event.relatedTarget)) close();
    });
    return element("div", { class: "menu-box" }, button, list);
  }

  /** What the menu offers: labels and acts. */
  exports() {
    const text = (write) => () => this.app.showText(this.title, write(this.answer));
    const withAnswer = (act) => () => (this.answer ? act() : this.app.say("There is nothing yet to take away."));
    return [
      ["Command line", withAnswer(text((a) => this.commandText(a)))],
      ["Scene (TOML)", withAnswer(text((a) => toml(a.command, a.options)))],
      ["Python", withAnswer(text((a) => python(a.command, a.options, this.app.systemNames())))],
      ["Numbers (CSV)", withAnswer(() => download(`${this.name}.csv`, this.csv(), "text/csv"))],
      ["Picture (SVG)", () => this.saveSvg()],
      ["Picture (PNG)", () => this.savePng()],
    ];
  }

  commandText(answer) {
    const files = filesOf(answer.options).map(([file, content]) => `# ${file}:\n${content}`);
    return [commandLine(answer.command, answer.options), ...files].join("\n\n");
  }

  csv() {
    return csv(this.answer);
  }

  async saveSvg() {
    const svg = this.svg();
    if (svg) download(`${this.name}.svg`, svg, "image/svg+xml");
    else this.app.say("There is no picture yet.");
  }

  /** What is drawn, as SVG. */
  svg() {
    return this.description ? svgOf(this.description, this.view()) : null;
  }

  async savePng() {
    if (!this.description) return this.app.say("There is no picture yet.");
    if (this.owes) this.drawNow();
    download(`${this.name}.png`, await pngOf(this.canvas), "image/png");
  }

  view() {
    const box = this.canvas.getBoundingClientRect();
    return { width: Math.max(box.width, 50), height: Math.max(box.height, 50), theme: themeOf(this.element), ranges: this.ranges };
  }

  /** Shows a drawing. */
  show(description) {
    this.description = description;
    this.redraw();
  }

  redraw() {
    if (!this.canvas || !this.canvas.isConnected) return;
    this.owes = !this.visible;
    clearTimeout(this.later);
    if (this.owes) {
      this.later = setTimeout(() => this.owes && this.canvas.isConnected && this.drawNow(), LATER);
      return;
    }
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    this.owes = false;
    const view = this.view();
    const surface = new CanvasSurface(this.canvas, view);
    if (this.description) this.hits = draw(surface, this.description, view);
    else {
      surface.clear(null);
      this.hits = null;
    }
    this.overlay?.(surface, view);
  }

  /** Nothing of another system is shown. */
  clear() {
    this.answer = null;
    this.took = null;
    this.problem.hidden = true;
    if (this.canvas) this.show(null);
  }

  /** Says that this is being computed, or how long it took. */
  busy(slots, mine) {
    const works = mine.some((slot) => slots.includes(slot));
    if (works === this.works && this.status.textContent === (works ? "computing" : (this.took ?? ""))) return;
    this.works = works;
    this.element.setAttribute("aria-busy", String(works));
    if (works && !this.element.classList.contains("busy")) this.status.textContent = "computing";
    if (!works) this.status.textContent = this.took ?? "";
    this.element.classList.toggle("busy", works);
  }

  /** An answer that has come, or a part of it; whether there is something to show. */
  take(answer) {
    this.answer = answer;
    const wrong = answer.error && answer.error.kind !== "saved" ? answer.error.message : null;
    this.problem.hidden = !wrong;
    this.problem.textContent = wrong ?? "";
    this.element.classList.toggle("stale", Boolean(answer.error));
    if (answer.milliseconds !== null) this.took = inWords(answer.milliseconds);
    if (answer.reached !== null && answer.milliseconds === null) this.status.textContent = `${Math.round(100 * answer.reached)} %`;
    return !answer.error;
  }

  /** Zoom by wheel and keys, and the value under the pointer. */
  listen() {
    this.canvas.addEventListener("pointermove", (event) => this.point(event));
    this.canvas.addEventListener("pointerleave", () => (this.tip.hidden = true));
    this.canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.shiftKey && !this.zoomsByWheel) return;
      event.preventDefault();
      this.zoomAt(event, Math.exp(event.deltaY * 0.0015));
    }, { passive: false });
    this.canvas.addEventListener("dblclick", () => this.resetZoom());
    this.canvas.addEventListener("keydown", (event) => {
      if (event.key === "+" || event.key === "=") this.zoomAt(null, 0.8);
      else if (event.key === "-") this.zoomAt(null, 1.25);
      else if (event.key === "0") this.resetZoom();
      else return;
      event.preventDefault();
    });
  }

  at(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  point(event) {
    const [px, py] = this.at(event);
    const near = this.hits?.nearest(px, py, 12);
    const text = near ? this.tipOf(near) : null;
    this.tip.hidden = !text;
    if (!text) return;
    this.tip.textContent = text;
    const width = this.canvas.clientWidth;
    this.tip.style.left = `${Math.min(px + 12, Math.max(width - 200, 0))}px`;
    this.tip.style.top = `${py + 14}px`;
  }

  /** What is said of the point under the pointer. */
  tipOf({ label, x, y }) {
    const at = `${short(x)}, ${short(y)}`;
    return label ? `${label}: ${at}` : at;
  }

  zoomAt(event, factor) {
    const panel = singlePanel(this.description);
    if (!panel || !this.hits) return;
    const frame = this.hits.frames[0];
    const [px, py] = event ? this.at(event) : [frame.x + frame.width / 2, frame.y + frame.height / 2];
    const corner = (fx, fy) => this.hits.toData(px + (fx - px) * factor, py + (fy - py) * factor, 0);
    const low = corner(frame.x, frame.y + frame.height);
    const high = corner(frame.x + frame.width, frame.y);
    this.zoom({ x: [low.x, high.x], y: [low.y, high.y] });
  }

  zoom(ranges) {
    this.ranges = ranges;
    this.redraw();
  }

  resetZoom() {
    this.ranges = null;
    this.redraw();
  }
}

/** The panel of a description that has one alone. */
export function singlePanel(description) {
  const panels = panelsOf(description);
  return panels.length === 1 ? panels[0] : null;
}

/** All panels of a description, in their order. */
function panelsOf(description) {
  if (!description) return [];
  return description.blocks ? description.blocks.flatMap((block) => block.columns.flat()) : [description];
}

/** A time as people say it. */
export function inWords(milliseconds) {
  return milliseconds < 1000 ? `${Math.max(1, Math.round(milliseconds))} ms` : `${(milliseconds / 1000).toPrecision(2)} s`;
}

/** A number with at most seven digits. */
export function short(x) {
  if (x === null || x === undefined) return "-";
  if (x === 0) return "0";
  const size = Math.abs(x);
  return size >= 1e-4 && size < 1e7 ? String(Number(x.toPrecision(7))) : x.toExponential(5).replace(/\.?0+e/, "e");
}

/** A number with its bound, as many digits as that leaves. */
export function bounded(value, uncertainty) {
  if (value === null || value === undefined) return "-";
  if (!(uncertainty > 0)) return short(value);
  const digits = Math.floor(Math.log10(Math.abs(value) || 1)) - Math.floor(Math.log10(uncertainty)) + 1;
  const shown = digits > 17 ? String(value) : value.toPrecision(Math.min(Math.max(digits, 2), 17));
  return `${shown} ± ${uncertainty >= 1e-4 && uncertainty < 1000 ? Number(uncertainty.toPrecision(1)) : uncertainty.toExponential(0)}`;
}
