// SPDX-License-Identifier: MIT
// The path of two axes of a CNC872, in one scale for both.
import { word } from "./words.js";
import { make, makeSvg, write } from "./make.js";

const WIDTH = 640, HEIGHT = 360, EDGE = 30;
const POINTS_MAX = 4000; // then every second one goes

export class CncPath {
  constructor() {
    this.element = make("section", { class: "path" });
    this.names = [];
    this.chosen = null; // the names of the two axes
    this.points = [];   // positions of all axes, in mm
    this.time = 0;
    this.isDue = false;
  }

  build() {
    this.axes = ["cnc-across", "cnc-up"].map((name, at) => {
      const select = make("select", { "aria-label": word(name), onchange: () => this.choose(at, select.value) });
      return select;
    });
    this.svg = makeSvg("svg", { class: "graph path", role: "img", viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
      "aria-label": word("cnc-path") });
    this.ranges = make("p", { class: "note" });
    this.element.replaceChildren(make("h3", {}, word("cnc-path")), make("div", { class: "row" },
      make("label", {}, word("cnc-across") + " ", this.axes[0]), make("label", {}, word("cnc-up") + " ", this.axes[1]),
      make("button", { onclick: () => this.clear() }, word("clear"))), this.svg, this.ranges);
  }

  showAxes(names) {
    const isOther = names.join() !== this.names.join();
    this.names = names;
    if (isOther)
      this.points = [];
    if (isOther || !this.chosen)
      this.chosen = [names[0], names[1] ?? names[0]];
    this.axes.forEach((select, at) => {
      select.replaceChildren(...names.map((name) => new Option(name)));
      select.value = this.chosen[at];
    });
    this.draw();
  }

  choose(at, name) {
    this.chosen[at] = name;
    this.draw();
  }

  clear() {
    this.points = this.points.slice(-1);
    this.draw();
  }

  // Positions in mm, in the order of the names, at a time in us.
  add(positions, t_us) {
    const last = this.points.at(-1);
    if (t_us < this.time)
      this.points = []; // a restored snapshot, another power-up: another past
    this.time = t_us;
    if (last && this.points.length > 0 && last.every((value, at) => value === positions[at]))
      return;
    this.points.push(positions);
    if (this.points.length > POINTS_MAX)
      this.points = this.points.filter((_, at) => at % 2 === 0 || at === this.points.length - 1);
    this.draw();
  }

  draw() {
    if (this.isDue)
      return;
    this.isDue = true;
    requestAnimationFrame(() => { this.isDue = false; this.paint(); });
  }

  // With the same scale in both directions.
  paint() {
    if (this.points.length === 0) {
      this.svg.replaceChildren();
      return;
    }
    const [across, up] = this.chosen.map((name) => this.points.map((point) => point[this.names.indexOf(name)]));
    const [left, right, low, high] = [Math.min(...across), Math.max(...across), Math.min(...up), Math.max(...up)];
    const scale = Math.min((WIDTH - 2 * EDGE) / Math.max(right - left, 1), (HEIGHT - 2 * EDGE) / Math.max(high - low, 1));
    const x = (at) => (EDGE + (across[at] - left) * scale).toFixed(1);
    const y = (at) => (HEIGHT - EDGE - (up[at] - low) * scale).toFixed(1), end = across.length - 1;
    const line = "M" + across.map((_, at) => `${x(at)} ${y(at)}`).join("L");
    const text = (name, from, to) => `${name} ${from.toFixed(3)} … ${to.toFixed(3)}`;
    this.svg.replaceChildren(makeSvg("path", { class: "curve", d: line }),
      makeSvg("circle", { cx: x(end), cy: y(end), r: 5, class: "carriage" }));
    write(this.ranges, `${text(this.chosen[0], left, right)}\n${text(this.chosen[1], low, high)}`);
  }
}
