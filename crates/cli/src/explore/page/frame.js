// What surrounds the panes: the head of the page with its buttons, the columns, messages and texts to copy.

import { button, element } from "./elements.js";
import { openGlossary } from "./glossary.js";
import { copied } from "./out.js";
import { toAddress } from "./scene.js";

const THEMES = { auto: "light", light: "dark", dark: "auto" };
/** A message stays so many milliseconds, and longer the longer it is. */
const SHOWN = 4000;

/** The theme of the notebook around the page, where that says it. */
function themeAround() {
  const { jpThemeLight, vscodeThemeKind } = document.body.dataset;
  if (jpThemeLight) return jpThemeLight === "true" ? "light" : "dark";
  if (vscodeThemeKind) return vscodeThemeKind.endsWith("light") ? "light" : "dark";
  return "auto";
}

export function frameOf(app) {
  return new Frame(app);
}

class Frame {
  constructor(app) {
    this.app = app;
    this.title = element("h1", {}, "twinslip");
    this.works = element("span", { class: "works", role: "status" });
    this.undo = button("Undo", () => app.undo(true), { title: "Undo (Ctrl+Z)" });
    this.redo = button("Redo", () => app.undo(false), { title: "Redo (Ctrl+Y)" });
    this.compare = button("Compare", () => app.compare(!app.scene.compare), { "aria-pressed": "false", title: "Two points side by side" });
    this.link = button("Link", () => this.copyLink(), { title: "Copy an address that shows this" });
    this.save = button("Save page", () => app.savePage(), { title: "This page as one file that needs no server" });
    this.words = button("Glossary", () => openGlossary(this.element), { title: "What the labels mean" });
    this.theme = button("Theme", () => app.change({ theme: THEMES[app.scene.theme] }), { title: "Automatic, light or dark" });
    const buttons = [this.undo, this.redo, this.compare, this.link, this.save, this.words, this.theme];
    this.message = element("div", { class: "message", role: "alert", hidden: true });
    this.main = element("main", {});
    this.element = element(
      "div",
      { class: "twinslip" },
      element("header", { class: "head" }, this.title, this.works, element("div", { class: "buttons", role: "toolbar", "aria-label": "Page" }, ...buttons)),
      this.message,
      this.main,
    );
    this.element.addEventListener("keydown", (event) => this.key(event));
  }

  /** The panes in their columns. */
  fill(app) {
    this.left = element("div", { class: "column plane" }, app.diagram.element, app.alongs.x.element, app.alongs.y.element, app.bands.element);
    this.columns = app.points.map((point, i) => {
      const name = element("p", { class: "point-name" }, `Point ${"AB"[i]}`);
      return element("div", { class: "column point" }, name, ...point.all.map((pane) => pane.element));
    });
    this.main.replaceChildren(app.side.element, this.left, ...this.columns);
  }

  /** A saved page computes nothing: what asks is switched off. */
  fix() {
    const note = "A saved page: pictures can be zoomed, turned and taken away; to compute, run twinslip explore.";
    this.main.before(element("p", { class: "note" }, note));
    for (const field of this.app.side.element.querySelectorAll("input, select, textarea, button")) field.disabled = true;
    for (const one of [this.compare, this.save, this.link, this.undo, this.redo]) one.hidden = true;
  }

  layout(app) {
    this.element.dataset.theme = app.scene.theme === "auto" ? themeAround() : app.scene.theme;
    this.columns[1].hidden = !app.scene.compare;
    this.main.classList.toggle("compares", app.scene.compare);
    for (const column of this.columns) column.firstChild.hidden = !app.scene.compare;
  }

  refresh(app) {
    this.undo.disabled = !app.history.past.length;
    this.redo.disabled = !app.history.future.length;
    this.compare.setAttribute("aria-pressed", String(app.scene.compare));
    this.theme.textContent = `Theme: ${app.scene.theme}`;
    if (!app.engine.transport.save) this.save.hidden = true;
  }

  busy(slots) {
    if (slots.join() === this.slots) return;
    this.slots = slots.join();
    const names = [...new Set(slots.map((slot) => slot.split(":")[0].replace("locus", "curves").replace("branch", "branches")))];
    this.works.textContent = names.length ? `computing ${names.slice(0, 3).join(", ")}${names.length > 3 ? " ..." : ""}` : "";
    this.works.classList.toggle("spins", names.length > 0);
    this.element.dataset.busy = String(names.length > 0);
  }

  say(text, stays) {
    this.message.textContent = text;
    this.message.hidden = false;
    clearTimeout(this.hiding);
    if (!stays) this.hiding = setTimeout(() => (this.message.hidden = true), SHOWN + 40 * text.length);
  }

  async copyLink() {
    const address = new URL(toAddress(this.app.scene), window.location.href).href;
    if (await copied(address)) this.say("The address is on the clipboard. Behind # it has all that is shown here: any page of twinslip explore takes that part.");
    else this.showText("Link", address);
  }

  showText(title, text) {
    const area = element("pre", { tabindex: "0" }, text);
    const copy = button("Copy", async () => {
      copy.textContent = (await copied(text)) ? "Copied" : "Select and copy";
    });
    const dialog = element("dialog", { "aria-label": title }, element("h2", {}, title), area, copy, button("Close", () => dialog.close()));
    dialog.addEventListener("close", () => dialog.remove());
    this.element.append(dialog);
    dialog.showModal();
  }

  key(event) {
    if (/^(INPUT|TEXTAREA)$/.test(event.target.tagName)) return;
    const control = event.ctrlKey || event.metaKey;
    if (control && event.key.toLowerCase() === "z") this.app.undo(!event.shiftKey);
    else if (control && event.key.toLowerCase() === "y") this.app.undo(false);
    else return;
    event.preventDefault();
  }
}
