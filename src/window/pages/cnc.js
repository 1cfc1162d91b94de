// SPDX-License-Identifier: MIT
// The panel of a CNC872 (docs/CNC872.md): axes, block, stops, spindle, PLC program; keys, pots and switches of its operator;
// cells; the path of the first two axes. All of it by the methods cnc.… of the control socket.
import { word } from "./words.js";
import { group, make, makeScrolled, makeSvg, write } from "./make.js";

const FIELDS = ["axis", "state", "position", "actual", "difference", "homed", "enabled"];
const LINES = ["block", "feed", "stops", "plc", "spindle"];
const SWITCHES = ["rapid", "hand", "block_by_block", "m01", "indication", "simulation", "high_speed"];
const PASSES = ["–", "init", "move", "delay", "done"];
const WIDTH = 640, HEIGHT = 360, EDGE = 30; // of the path
const POINTS_MAX = 4000; // of it; then every second one goes

const yes = (value) => word(value ? "yes" : "no");
const inMm = (u) => Math.floor(u / 65536) / 1000; // whole um
const mm = (u) => inMm(u).toFixed(3);
const names = (object) => Object.keys(object).filter((name) => object[name] === true).join(" ") || "–";

const texts = {
  axis: (axis, name) => name, position: (axis) => mm(axis.position), actual: (axis) => mm(axis.actual),
  homed: (axis) => yes(axis.homed), enabled: (axis) => yes(axis.enabled),
};

const lines = {
  block: ({ block }) => word("cnc-block-text", block.phase, block.block ?? "–", block.line ?? "–", block.next, block.blocks),
  feed: (cnc) => word("cnc-feed-text", (cnc.speed * 15 / 16384).toFixed(1), cnc.panel.feed, cnc.panel.mode),
  stops: ({ stops }) => names(stops),
  plc: (cnc) => word("cnc-plc-text", PASSES[cnc.plc_pass] ?? "?", cnc.plc_error.toString(16).toUpperCase() + "h", cnc.critical),
  spindle: ({ spindle, panel }) =>
    word("cnc-spindle-text", spindle.turns, spindle.actual, spindle.required, spindle.gear, panel.spindle),
};

export class CncPanel {
  constructor(unit, act) {
    this.unit = unit;
    this.act = act;
    this.element = make("section", { class: "device" });
    this.points = [];
    this.time = 0;
  }

  // All of it anew, in the present language.
  build() {
    this.names = null;
    this.result = make("p", { class: "note", role: "status" });
    this.body = make("tbody");
    const heads = FIELDS.map((field) => make("th", { scope: "col" }, word("cnc-" + field)));
    this.lines = LINES.map(() => make("dd"));
    const list = LINES.map((line, at) => make("div", {}, make("dt", {}, word("cnc-" + line)), this.lines[at]));
    this.jog = make("div", { class: "row" });
    this.path = makeSvg("svg", { class: "graph path", role: "img", viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
      "aria-label": word("cnc-path") });
    const table = make("table", {}, make("thead", {}, make("tr", {}, ...heads)), this.body);
    this.element.replaceChildren(makeScrolled(table), make("dl", { class: "more lines" }, ...list), this.buildKeys(), this.jog,
      this.buildSwitches(), this.buildCell(), this.result, make("h3", {}, word("cnc-path")),
      make("button", { onclick: () => this.clearPath() }, word("clear")), this.path);
  }

  async call(method, params) {
    const answer = await this.act(method, params);
    write(this.result, answer.error ?? `${method}: ${word("done")}`);
    this.result.classList.toggle("wrong", Boolean(answer.error));
    return answer;
  }

  press(params) { return this.call("cnc.panel", params); }

  // Stop all: no key of an axis stays pressed.
  stop() {
    const jog = Object.fromEntries((this.names ?? []).map((name) => [name, ""]));
    return this.press({ stop: true, jog });
  }

  // ---- Keys and switches ----

  buildKeys() {
    const key = (name, params, attributes = {}) => make("button", { ...attributes, onclick: () => this.press(params()) }, name);
    this.mode = make("select", { "aria-label": word("cnc-mode"), onchange: () => this.press({ mode: this.mode.value }) });
    this.mode.append(new Option(word("cnc-aut"), "aut"), new Option(word("cnc-manual"), "manual"));
    this.home = make("select", { "aria-label": word("cnc-axis") });
    this.pots = ["feed", "spindle"].map((name) => {
      const range = make("input", { type: "range", min: 0, max: 200, step: 1, "aria-label": word("cnc-pot-" + name) });
      range.onchange = () => this.press({ [name]: Number(range.value) });
      return { name, range, text: make("output") };
    });
    const pots = this.pots.map(({ name, range, text }) => make("label", {}, word("cnc-pot-" + name) + " ", range, text));
    return make("div", { class: "row" }, key("START", () => ({ start: true })),
      key("STOP", () => ({ stop: true }), { class: "stop" }), key("RESET", () => ({ reset: true })),
      make("label", {}, word("cnc-mode") + " ", this.mode),
      make("label", {}, word("cnc-axis") + " ", this.home), key(word("cnc-home"), () => ({ home: this.home.value })), ...pots);
  }

  // A key that moves an axis as long as it is held: with the mouse, a finger, Space or Enter.
  buildJogKey(name, sign) {
    const button = make("button", {}, name + (sign === "-" ? "−" : "+"));
    let held = false;
    const set = (now) => () => {
      if (held !== now)
        this.press({ jog: { [name]: now ? sign : "" } });
      held = now;
    };
    const ifKey = (act) => (event) => {
      if (event.key === " " || event.key === "Enter")
        act();
    };
    button.addEventListener("pointerdown", set(true));
    for (const event of ["pointerup", "pointerleave", "pointercancel", "blur"])
      button.addEventListener(event, set(false));
    button.addEventListener("keydown", ifKey(set(true)));
    button.addEventListener("keyup", ifKey(set(false)));
    return button;
  }

  buildSwitches() {
    const change = (name) => () => this.press({ [name]: !this.cnc.panel[name] });
    this.switches = SWITCHES.map((name) => make("button", { onclick: change(name) }, word("cnc-" + name)));
    return make("div", { class: "front" }, group(word("cnc-switches"), this.switches));
  }

  // Any cell, by its name.
  buildCell() {
    const cell = make("input", { value: this.cell ?? "STOP_REQ", spellcheck: "false", "aria-label": word("cnc-cell") });
    const value = make("input", { type: "number", value: 1, step: "any", "aria-label": word("cnc-value") });
    cell.oninput = () => { this.cell = cell.value; };
    const read = async () => {
      const answer = await this.call("cnc.get", { cells: [cell.value] });
      if (!answer.error)
        write(this.result, `${cell.value} = ${answer.cells[cell.value]}`);
    };
    const set = () => this.call("cnc.set", { cells: { [cell.value]: Number(value.value) } });
    return make("div", { class: "row" }, make("label", {}, word("cnc-cell") + " ", cell),
      make("button", { onclick: read }, word("cnc-read")), make("label", {}, word("cnc-value") + " ", value),
      make("button", { onclick: set }, word("cnc-set")));
  }

  // ---- The path of the first two axes ----

  clearPath() {
    this.points = this.points.slice(-1);
    this.drawPath();
  }

  addPoint(state) {
    const [x, y] = this.names.map((name) => inMm(state.cnc.axes[name].position)), last = this.points.at(-1);
    if (state.t_us < this.time)
      this.points = []; // a restored snapshot, another power-up: another past
    this.time = state.t_us;
    if (x === undefined || (this.points.length > 0 && last[0] === x && last[1] === (y ?? 0)))
      return;
    this.points.push([x, y ?? 0]);
    if (this.points.length > POINTS_MAX)
      this.points = this.points.filter((_, at) => at % 2 === 0 || at === this.points.length - 1);
    this.drawPath();
  }

  // With the same scale in both directions.
  drawPath() {
    const at = (axis) => this.points.map((point) => point[axis]);
    const [left, right, low, high] = [Math.min(...at(0)), Math.max(...at(0)), Math.min(...at(1)), Math.max(...at(1))];
    const scale = Math.min((WIDTH - 2 * EDGE) / Math.max(right - left, 1), (HEIGHT - 2 * EDGE) / Math.max(high - low, 1));
    const place = ([x, y]) => [EDGE + (x - left) * scale, HEIGHT - EDGE - (y - low) * scale].map((value) => value.toFixed(1));
    const [x, y] = place(this.points.at(-1)), [name, other = ""] = this.names;
    const line = "M" + this.points.map((point) => place(point).join(" ")).join("L");
    this.path.replaceChildren(makeSvg("path", { class: "curve", d: line }),
      makeSvg("circle", { cx: x, cy: y, r: 5, class: "carriage" }),
      makeSvg("text", { x: EDGE, y: HEIGHT - 8 }, `${name} ${left.toFixed(3)} … ${right.toFixed(3)} mm`),
      makeSvg("text", { x: EDGE, y: 18 }, `${other} ${low.toFixed(3)} … ${high.toFixed(3)} mm`));
  }

  // ---- State ----

  showAxes(axes) {
    this.names = Object.keys(axes);
    this.cells = this.names.map(() => FIELDS.map(() => make("td")));
    this.body.replaceChildren(...this.cells.map((row) => make("tr", {}, ...row)));
    this.home.replaceChildren(...this.names.map((name) => new Option(name)));
    this.keys = this.names.flatMap((name) => ["-", "+"].map((sign) => ({ name, sign, button: this.buildJogKey(name, sign) })));
    this.jog.replaceChildren(...this.keys.map(({ button }) => button));
    if (this.points.length > 0)
      this.drawPath();
  }

  show(state) {
    const { cnc } = state;
    this.cnc = cnc;
    if (!this.body)
      this.build();
    if (this.names?.join() !== Object.keys(cnc.axes).join())
      this.showAxes(cnc.axes);
    this.names.forEach((name, at) => FIELDS.forEach((field, column) =>
      write(this.cells[at][column], String(texts[field]?.(cnc.axes[name], name) ?? cnc.axes[name][field]))));
    LINES.forEach((line, at) => write(this.lines[at], lines[line](cnc)));
    this.switches.forEach((button, at) => button.setAttribute("aria-pressed", String(cnc.panel[SWITCHES[at]])));
    for (const { name, sign, button } of this.keys)
      button.setAttribute("aria-pressed", String(cnc.panel.jog[name] === sign));
    if (document.activeElement !== this.mode)
      this.mode.value = cnc.panel.mode;
    for (const { name, range, text } of this.pots) {
      if (!range.matches(":active"))
        range.value = cnc.panel[name];
      write(text, `${cnc.panel[name]} %`);
    }
    this.addPoint(state);
  }
}
