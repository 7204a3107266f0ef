// The words of the field, from the glossary of the documentation, for labels that are pointed at and for the page of words.

import { element } from "./elements.js";

let entries = new Map();
let text = "";

/** Takes the glossary: tables in Markdown, of which the first column is the term and the second or last its meaning. */
export function readGlossary(markdown) {
  text = markdown ?? "";
  entries = new Map();
  let meaning = 1;
  for (const line of text.split("\n")) {
    if (!line.startsWith("|")) continue;
    const cells = line.split("|").slice(1, -1).map((cell) => cell.trim().replaceAll("`", ""));
    if (/^-+$/.test(cells[0])) continue;
    const head = cells.findIndex((cell) => cell === "meaning" || cell === "what it is");
    if (head > 0) {
      meaning = head;
      continue;
    }
    for (const term of cells[0].replace(/\(.*?\)/g, "").split(",")) entries.set(term.trim().toLowerCase(), { name: term.trim(), words: cells[meaning] ?? "" });
  }
}

/** What a label or term means; null where the glossary has no such term. */
export function explained(label) {
  const plain = String(label).toLowerCase();
  if (entries.has(plain)) return entries.get(plain).words;
  const inner = /\(([A-Z0-9]+)\)/.exec(label);
  return inner ? (entries.get(inner[1].toLowerCase())?.words ?? null) : null;
}

/** A term that says on hover what it means, and opens the glossary there. */
export function term(label, shown = label) {
  const words = explained(label);
  if (!words) return document.createTextNode(shown);
  const link = element("a", { class: "term", href: `#term-${slug(label)}`, title: words }, shown);
  link.addEventListener("click", (event) => {
    event.preventDefault();
    openGlossary(link, label);
  });
  return link;
}

function slug(label) {
  return String(label).toLowerCase().replace(/[^a-z0-9]+/g, "-");
}

let dialog = null;

/** Opens the list of all terms in the page that an element is of, at one of them. */
export function openGlossary(from, label = null) {
  if (!dialog) {
    const list = element("dl", {});
    for (const { name, words } of entries.values()) list.append(element("dt", { id: `term-${slug(name)}` }, name), element("dd", {}, words));
    const close = element("button", { type: "button", class: "close" }, "Close");
    dialog = element("dialog", { class: "glossary", "aria-label": "Glossary" }, element("h2", {}, "Glossary"), close, list);
    close.addEventListener("click", () => dialog.close());
  }
  // The styles of the page are of elements in it.
  const page = from.closest(".twinslip");
  if (dialog.parentNode !== page) page.append(dialog);
  dialog.showModal();
  if (label) dialog.querySelector(`#term-${CSS.escape(slug(label))}`)?.scrollIntoView({ block: "center" });
}
