// What a fit leaves undecided: the law, or branches of equilibria, with bands.

import { element } from "../elements.js";
import { Pane } from "./pane.js";
import { requests } from "../requests.js";

export class BandsPane extends Pane {
  constructor(app) {
    super(app, { title: "Bands of the fit", name: "bands", height: 260 });
    const options = [["law", "friction law"], ["equilibria", "equilibria here"], ["x", "equilibria across"], ["y", "equilibria up"]];
    this.choice = element("select", { "aria-label": "What the bands are of" }, ...options.map(([value, words]) => element("option", { value }, words)));
    this.choice.addEventListener("change", () => this.ask());
    this.heading.after(this.choice);
  }

  ask() {
    const { app } = this;
    const { scene, model } = app;
    const what = this.choice.value;
    const asked = {
      law: () => this.withFit(requests.law(scene, model, scene.active)),
      equilibria: () => requests.bands(scene, model, scene.active),
      x: () => this.branch("x"),
      y: () => this.branch("y"),
    }[what]();
    app.engine.ask("bands", asked.command, asked.options, {
      background: true,
      first: true,
      onUpdate: (answer) => {
        if (this.take(answer) && answer.pictures.length) this.show(answer.pictures.at(-1));
      },
    });
  }

  branch(which) {
    const { scene, model } = this.app;
    const along = scene.axes[which] ?? scene.axes.x;
    return this.withFit(requests.branch(scene, model, scene.active, "equilibria", along));
  }

  withFit({ command, options }) {
    return { command, options: { ...requests.withFit(this.app.scene, options), plot: true } };
  }
}
