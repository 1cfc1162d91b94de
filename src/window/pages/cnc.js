// SPDX-License-Identifier: MIT
// The panel of a CNC872 (docs/CNC872.md): keys and switches of its operator, axes, block, stops, spindle, PLC program, displays,
// the path of two axes, curves, the NC program, cells, the PLC program. All of it by the methods cnc.… of the control socket.
import { word } from "./words.js";
import { Cells } from "./cells.js";
import { CncKeys } from "./cnc_keys.js";
import { CncPath } from "./cnc_path.js";
import { CncPlc } from "./cnc_plc.js";
import { CncText } from "./cnc_text.js";
import { Curves } from "./curves.js";
import { group, make, makeScrolled, write } from "./make.js";

const FIELDS = ["axis", "state", "position", "actual", "difference", "homed", "enabled"];
const LINES = ["block", "feed", "stops", "plc", "spindle"];
const PASSES = ["–", "init", "move", "delay", "done"];
const DISPLAYS = 2;

const yes = (value) => word(value ? "yes" : "no");
const inMm = (u) => Math.floor(u / 65536) / 1000; // whole um
const mm = (u) => inMm(u).toFixed(3);
const feedOf = (speed) => speed * 15 / 16384; // u/T in mm/min
const turns = (thousandths) => (thousandths / 1000).toFixed(1);
const names = (object) => Object.keys(object).filter((name) => object[name] === true).join(" ") || "–";

// Names of axes in their order: numbers would come first in an object.
const namesOf = (axes) => Object.keys(axes).sort((a, b) => (parseInt(a, 10) || a.charCodeAt(0) - 100)
  - (parseInt(b, 10) || b.charCodeAt(0) - 100));

const texts = {
  axis: (axis, name) => name, position: (axis) => mm(axis.position) + (axis.rotary ? "°" : ""),
  actual: (axis) => mm(axis.actual) + (axis.rotary ? "°" : ""), homed: (axis) => yes(axis.homed),
  enabled: (axis) => yes(axis.enabled),
};

const lines = {
  block: ({ block }, text) =>
    word("cnc-block-text", block.phase, block.block ?? "–", block.line ?? "–", block.next, block.blocks) + (text && `: ${text}`),
  feed: (cnc) => word("cnc-feed-text", feedOf(cnc.speed).toFixed(1), cnc.panel.feed, cnc.panel.mode),
  stops: ({ stops }) => names(stops),
  plc: (cnc) => word("cnc-plc-text", PASSES[cnc.plc_pass] ?? "?", cnc.plc_error.toString(16).toUpperCase() + "h", cnc.critical),
  spindle: ({ spindle, panel }) =>
    word("cnc-spindle-text", spindle.turns, turns(spindle.actual), turns(spindle.required), spindle.gear, panel.spindle),
};

export class CncPanel {
  constructor(unit, act) {
    this.act = act;
    this.element = make("section", { class: "device" });
    this.keys = new CncKeys(unit, (params, isQuiet) => this.call("cnc.panel", params, isQuiet));
    this.path = new CncPath();
    this.curves = new Curves(["cnc-feed-curve", "cnc-position-curve"]);
    this.text = new CncText((text, name) => this.call("cnc.load", { text, name }),
      { name: "program.nc", title: "cnc-program", loaded: "cnc-loaded", part: "program" });
    this.plc = new CncPlc(unit, (plc, plc_name) => this.call("cnc.load", { plc, plc_name }));
    this.cells = new Cells(unit, (cells) => this.call("cnc.set", { cells }));
    this.begin();
  }

  // The emulator is another one, or the same one again.
  begin() {
    this.text.loaded = null;
    this.cells.begin();
    this.plc.begin();
  }

  // All of it anew, in the present language.
  build() {
    this.names = null;
    this.result = make("p", { class: "note", role: "status" });
    this.body = make("tbody");
    const heads = FIELDS.map((field) => make("th", { scope: "col" }, word("cnc-" + field)));
    const table = make("table", { class: "axes" }, make("thead", {}, make("tr", {}, ...heads)), this.body);
    this.lines = LINES.map(() => make("dd"));
    const list = LINES.map((line, at) => make("div", {}, make("dt", {}, word("cnc-" + line)), this.lines[at]));
    this.displays = Array.from({ length: DISPLAYS }, (_, at) =>
      make("pre", { class: "display", "aria-label": `${word("cnc-display")} ${at + 1}`, role: "group", tabindex: "0" }));
    const displays = this.displays.map((display, at) => group(`${word("cnc-display")} ${at + 1}`, [display]));
    for (const part of [this.keys, this.path, this.curves, this.text, this.cells, this.plc])
      part.build();
    const state = make("section", {}, makeScrolled(table), make("dl", { class: "more lines" }, ...list), this.cells.lamps,
      make("div", { class: "row" }, ...displays));
    this.element.replaceChildren(this.keys.element, this.result,
      make("div", { class: "columns" }, state, this.path.element), this.curves.element,
      make("div", { class: "columns" }, this.cells.element, this.text.element), this.plc.element);
  }

  async call(method, params, isQuiet) {
    const answer = await this.act(method, params);
    write(this.result, answer.error ?? (isQuiet ? "" : `${method}: ${word("done")}`));
    this.result.classList.toggle("wrong", Boolean(answer.error));
    return answer;
  }

  // Stop all: no key of an axis stays pressed.
  stop() {
    const jog = Object.fromEntries((this.names ?? []).map((name) => [name, ""]));
    return this.call("cnc.panel", { stop: true, jog });
  }

  // ---- State ----

  showAxes(axes) {
    this.names = namesOf(axes);
    this.fields = this.names.map(() => FIELDS.map(() => make("td")));
    this.body.replaceChildren(...this.fields.map((row) => make("tr", {}, ...row)));
    this.keys.showAxes(this.names);
    this.path.showAxes(this.names);
    this.curves.showAxes(this.names);
  }

  showDisplay(element, { lines: rows, inverse }) {
    write(element, rows.join("\n"));
    element.classList.toggle("inverse", inverse !== 0);
  }

  show({ t_us, cnc, powered }) {
    if (!this.body)
      this.build();
    if (powered && (this.powered === false || (this.loads !== undefined && this.loads !== cnc.plc_loads)))
      this.begin(); // without power it has no cells; another PLC program has others
    this.loads = cnc.plc_loads;
    this.powered = powered;
    if (this.names?.join() !== namesOf(cnc.axes).join())
      this.showAxes(cnc.axes);
    this.names.forEach((name, at) => FIELDS.forEach((field, column) =>
      write(this.fields[at][column], String(texts[field]?.(cnc.axes[name], name) ?? cnc.axes[name][field]))));
    LINES.forEach((line, at) => write(this.lines[at], lines[line](cnc, this.text.lineText(cnc.block.line))));
    this.displays.forEach((element, at) => this.showDisplay(element, cnc.displays[at]));
    this.keys.show(cnc.panel);
    const positions = this.names.map((name) => inMm(cnc.axes[name].position));
    this.path.add(positions, t_us);
    this.curves.add(0, 0, t_us / 1000, feedOf(cnc.speed));
    positions.forEach((value, at) => this.curves.add(1, at, t_us / 1000, value));
  }
}
