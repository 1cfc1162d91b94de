// SPDX-License-Identifier: MIT
// The window of a motion controller PMC-1HS or PMC-2HS (docs/PMC.md): manual moves, home search, program, parameters, files. All
// of it by the methods pmc.… of the control socket.
import { word } from "./words.js";
import { saveText } from "./editor.js";
import { group, make, makeScrolled, write } from "./make.js";

const FILES = { program: "program.pmc", parameters: "parameters.txt" };
const FIELDS = ["axis", "state", "position", "display", "actual", "speed", "reg", "homed", "errors", "repetitions"];

const texts = {
  reg: (axis) => axis.reg === null || axis.reg === undefined ? "–" : `${String(axis.reg).padStart(2, "0")} ${axis.command ?? ""}`,
  homed: (axis) => word(axis.homed ? "yes" : axis.not_homed ? "not-homed" : "no"),
  errors: (axis) => (axis.errors ?? []).join(" ") || "–",
  repetitions: (axis) => (axis.repetitions ?? []).map((one) => `${one.reg}: ${one.left}`).join(", ") || "–",
};

export class PmcPanel {
  constructor(unit, act) {
    this.unit = unit;
    this.act = act;
    this.element = make("section", { class: "device" });
    this.edited = { program: "", parameters: "" };
    this.known = "";
  }

  // All of it anew, in the present language.
  build(axes) {
    this.names = axes === 1 ? ["X"] : ["X", "Y"];
    const heads = make("tr", {}, ...FIELDS.map((field) => make("th", { scope: "col" }, word("pmc-" + field))));
    this.cells = this.names.map(() => FIELDS.map(() => make("td")));
    const rows = this.cells.map((row) => make("tr", {}, ...row));
    const table = make("table", {}, make("thead", {}, heads), make("tbody", {}, ...rows));
    this.link = make("p", { class: "note" });
    this.result = make("p", { class: "note", role: "status" });
    this.element.replaceChildren(this.link, makeScrolled(table), this.buildManual(), this.buildRun(), this.result,
      make("div", { class: "columns" }, this.buildEditor("program"), this.buildEditor("parameters")));
  }

  button(text, method, params, attributes = {}) {
    return make("button", { ...attributes, onclick: () => this.call(method, params()) }, text);
  }

  number(name, value, low, high) {
    return make("input", { type: "number", value, min: low, max: high, "aria-label": name });
  }

  async call(method, params) {
    const answer = await this.act(method, params);
    write(this.result, answer.error ?? `${method}: ${word("done")}`);
    this.result.classList.toggle("wrong", Boolean(answer.error));
    return answer;
  }

  // Stop all.
  stop() { return this.call("pmc.stop", {}); }

  // ---- Manual mode: continuous, absolute or relative, at the fifth speed ----

  buildManual() {
    this.mode = make("select", { "aria-label": word("pmc-mode"), onchange: () => this.showMode() });
    this.mode.append(...["continuous", "absolute", "relative"].map((mode) => new Option(word("pmc-" + mode), mode)));
    this.moves = this.names.map((name) => this.buildMove(name));
    const parts = [make("label", {}, word("pmc-mode") + " ", this.mode), ...this.moves.flatMap((move) => move.parts)];
    const element = make("div", { class: "row" }, ...parts);
    this.showMode();
    return element;
  }

  buildMove(name) {
    const key = name.toLowerCase(), distance = this.number(`${word("position")} ${name}`, 0, -8388608, 8388607);
    const speed = this.number(`${word("speed")} ${name}`, 10, 1, 8000);
    speed.onchange = () => this.call("pmc.speed", { [key]: Number(speed.value) });
    const jog = ["-", "+"].map((sign) => this.button(name + (sign === "-" ? "−" : "+"), "pmc.jog", () => ({ [key]: sign })));
    const move = this.button(`${word("pmc-move")} ${name}`, "pmc.move",
      () => ({ [key]: Number(distance.value), relative: this.mode.value === "relative" }));
    const fixed = [1, 2, 3, 4].map((at) => make("button", { onclick: () => this.takeSpeed(name, at, speed) }, "V" + at));
    const speeds = group(`${word("speed")} ${name}`, [speed, ...fixed]);
    return { speed, jog, absolute: [distance, move], parts: [speeds, group(name, [...jog, distance, move])] };
  }

  showMode() {
    const continuous = this.mode.value === "continuous";
    for (const move of this.moves) {
      move.jog.forEach((button) => { button.hidden = !continuous; });
      move.absolute.forEach((element) => { element.hidden = continuous; });
    }
  }

  // The fifth speed becomes one of the four that the parameters have.
  async takeSpeed(name, at, speed) {
    const answer = await this.call("pmc.parameters", {});
    const section = (answer.text ?? "").split(/^\[/m).find((part) => part.startsWith(name + "]")) ?? "";
    const found = new RegExp(`^\\s*speed${at}\\s*=\\s*(\\d+)`, "m").exec(section);
    if (!found)
      return;
    speed.value = found[1];
    this.call("pmc.speed", { [name.toLowerCase()]: Number(found[1]) });
  }

  // ---- Home search, program, positions ----

  buildRun() {
    this.axes = make("select", { "aria-label": word("pmc-axis") });
    this.axes.append(...(this.names.length > 1 ? ["XY", ...this.names] : this.names).map((name) => new Option(name)));
    this.register = this.number("REG", 0, 0, 63);
    const chosen = () => ({ axes: this.axes.value.toLowerCase() });
    const reg = () => ({ ...chosen(), reg: Number(this.register.value) });
    const buttons = [
      this.button(word("pmc-stop"), "pmc.stop", chosen, { class: "stop" }),
      this.button(word("pmc-stop-now"), "pmc.stop", () => ({ ...chosen(), at_once: true }), { class: "stop" }),
      this.button(word("pmc-home"), "pmc.home", chosen), this.button(word("pmc-run"), "pmc.run", reg),
      this.button(word("pmc-end"), "pmc.end", chosen), this.button(word("pmc-register"), "pmc.register_position", reg),
      this.button(word("pmc-clear-errors"), "pmc.clear_errors", chosen),
      this.button(word("pmc-clear-counters"), "pmc.clear_counters", chosen),
      this.button(word("pmc-reset"), "pmc.reset", () => ({})),
    ];
    return make("div", { class: "row" }, make("label", {}, word("pmc-axis") + " ", this.axes),
      make("label", {}, "REG ", this.register), ...buttons);
  }

  // ---- Editors and files ----

  buildEditor(what) {
    const area = make("textarea", { class: "plain", spellcheck: "false", "aria-label": word("pmc-" + what) });
    const file = make("input", { type: "file", hidden: "", tabindex: "-1", "aria-hidden": "true" });
    area.value = this.edited[what];
    area.oninput = () => { this.edited[what] = area.value; };
    const put = (text) => { area.value = this.edited[what] = text; };
    file.onchange = async () => {
      if (file.files[0])
        put(await file.files[0].text());
      file.value = "";
    };
    const exchange = async (params) => {
      const answer = await this.call("pmc." + what, params);
      if (answer.text !== undefined)
        put(answer.text);
      return answer;
    };
    const buttons = [
      make("button", { onclick: () => exchange({}) }, word("pmc-read")),
      make("button", { onclick: () => exchange({ text: area.value }) }, word("pmc-write")),
      this.button(word("pmc-store"), "pmc.store", () => ({ axes: this.axes.value.toLowerCase() })),
      make("button", { onclick: () => file.click() }, word("open")),
      make("button", { onclick: () => saveText(area.value, FILES[what]) }, word("save")),
    ];
    const row = make("div", { class: "row" }, ...buttons, file);
    return make("section", { class: what }, make("h3", {}, word("pmc-" + what)), row, area);
  }

  // ---- State ----

  show(state) {
    if (this.cells === undefined || this.cells.length !== state.motors.length)
      this.build(state.motors.length);
    const { requests, answers, dropped } = state.counters ?? {};
    write(this.link, word("pmc-link", state.face ?? "", state.baud ?? "", requests ?? 0, answers ?? 0, dropped ?? 0));
    state.motors.forEach((axis, at) => {
      FIELDS.forEach((field, column) => write(this.cells[at][column], String(texts[field]?.(axis) ?? axis[field] ?? "–")));
      const { speed } = this.moves[at];
      if (document.activeElement !== speed && axis.fifth_speed !== undefined)
        speed.value = axis.fifth_speed;
    });
  }
}
