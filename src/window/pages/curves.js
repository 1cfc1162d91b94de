// SPDX-License-Identifier: MIT
// Curves of the axes of a CNC872 over the last minute: the speed along the path, and the positions of the axes that are chosen.
import { word } from "./words.js";
import { Graph } from "./graph.js";
import { make } from "./make.js";

const AXES_MAX = 16;

export class Curves {
  // The words for the two bands.
  constructor(titles) {
    this.titles = titles;
    this.names = [];
    this.hidden = new Set(); // names of axes that are not to be shown
    this.element = make("section", { class: "curves" });
  }

  build() {
    const canvas = make("canvas", { class: "graph", role: "img", "aria-label": word("cnc-curves") }), old = this.graph;
    this.graph = new Graph(canvas, 2, AXES_MAX);
    this.graph.titles = this.titles.map((title) => word(title));
    if (old)
      this.graph.take(old);
    this.choice = make("fieldset", { class: "choice" });
    this.element.replaceChildren(make("h3", {}, word("cnc-curves")), this.choice, canvas);
    this.showChoice();
  }

  showAxes(names) {
    if (names.join() !== this.names.join())
      this.graph.clear();
    this.names = names;
    this.showChoice();
  }

  showChoice() {
    this.choice.replaceChildren(make("legend", {}, word("cnc-shown")), ...this.names.map((name, at) => {
      const box = make("input", { type: "checkbox" });
      box.checked = !this.hidden.has(name);
      box.onchange = () => {
        this.hidden[box.checked ? "delete" : "add"](name);
        this.showHidden();
      };
      return make("label", { class: `check curve-${at % 4 + 1}` }, box, " " + name);
    }));
    this.showHidden();
  }

  showHidden() {
    const numbers = this.names.flatMap((name, at) => this.hidden.has(name) ? [at] : []);
    this.graph.hide(1, new Set(numbers));
  }

  add(band, axis, time, value) { this.graph.add(band, axis, time, value); }
}
