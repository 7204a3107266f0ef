// Where the page begins: in a browser that a server or a file has sent it to, or as the widget of a notebook.

import { App } from "./app.js";
import { Engine, HttpTransport, RecordedTransport, WidgetTransport } from "./engine.js";
import { readGlossary } from "./glossary.js";

/** Shows the page in an element; `begin` says what with. */
export function show(root, transport, begin) {
  readGlossary(begin.glossary);
  const app = new App(root, new Engine(transport), begin);
  app.start();
  return app;
}

/** The widget of a notebook, as anywidget has it. */
export function render({ model, el }) {
  const begin = JSON.parse(model.get("begin"));
  const transport = new WidgetTransport(model);
  const app = show(el, transport, { ...begin, inNotebook: true });
  return () => {
    app.engine.stopWhere(() => true);
    transport.close();
  };
}

// A notebook may have a heading of that name.
const told = globalThis.document?.querySelector("script#begin");
if (told) {
  const begin = JSON.parse(told.textContent || "{}");
  const transport = begin.saved ? new RecordedTransport(begin.saved.recording) : new HttpTransport("./");
  globalThis.twinslip = show(document.body, transport, { ...begin, address: window.location.hash });
}
