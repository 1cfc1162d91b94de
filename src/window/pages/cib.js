// SPDX-License-Identifier: MIT
// The panel of a CIB module (docs/CIB.md): drives with their phases, outputs, PWM, configuration. All of it by the methods cib.…
// of the control socket.
import { word } from "./words.js";
import { group, lamp, light, make, makeScrolled, write } from "./make.js";

const BITS = ["move", "dir", "invel", "trg", "err", "ramp"];
const FIELDS = ["drive", "configured", "state", "position", "speed", "row", "mcerr", "start_speed", "acceleration",
  "deceleration", "stop_deceleration"];
const COMMANDS = [101, 102, 105, 108, 109, 100, 9, 11, 12, 13, 14, 0];
const OUTPUTS = [1, 2, 3, 4, 5, 6, 7, 8];

export class CibPanel {
  constructor(unit, act) {
    this.unit = unit;
    this.act = act;
    this.element = make("section", { class: "device" });
    this.text = "";
  }

  // All of it anew, in the present language.
  build() {
    const head = (field) => make("th", { scope: "col" }, word("cib-" + field));
    this.drives = ["A", "B"].map((name, at) => ({
      cells: FIELDS.map(() => make("td")), bits: BITS.map((bit) => lamp(bit.toUpperCase())),
      phases: [1, 2, 3, 4].map((phase) => lamp("DO" + (phase + 4 * at))),
    }));
    const rows = this.drives.map(({ cells, bits, phases }) =>
      make("tr", {}, ...cells, make("td", {}, ...bits), make("td", {}, ...phases)));
    const table = make("table", {}, make("thead", {}, make("tr", {}, ...[...FIELDS, "mcstat", "phases"].map(head))),
      make("tbody", {}, ...rows));
    this.result = make("p", { class: "note", role: "status" });
    this.element.replaceChildren(makeScrolled(table), this.buildCommand(), this.buildOutputs(), this.result,
      this.buildConfiguration());
  }

  async call(method, params = {}) {
    const answer = await this.act(method, params);
    write(this.result, answer.error ?? `${method}: ${word("done")}`);
    this.result.classList.toggle("wrong", Boolean(answer.error));
    return answer;
  }

  // Stop all.
  stop() { return Promise.all(["A", "B"].map((drive) => this.call("cib.command", { drive, command: 108 }))); }

  buildCommand() {
    const drive = make("select", { "aria-label": word("cib-drive") });
    const command = make("select", { "aria-label": word("command") });
    drive.append(new Option("A"), new Option("B"));
    command.append(...COMMANDS.map((number) => new Option(`${number} ${word("cib-command-" + number)}`, String(number))));
    const number = (name, value) => make("input", { type: "number", value, "aria-label": name });
    const p1 = number("P1", 1000), p2 = number("P2", 1000);
    const send = () => this.call("cib.command",
      { drive: drive.value, command: Number(command.value), p1: Number(p1.value), p2: Number(p2.value) });
    const onStop = (name) => this.call("cib.command", { drive: name, command: 108 });
    const stop = (name) => make("button", { class: "stop", onclick: () => onStop(name) }, `${word("pmc-stop")} ${name}`);
    const labels = [[word("cib-drive"), drive], [word("command"), command], ["P1", p1], ["P2", p2]];
    return make("div", { class: "row" }, ...labels.map(([name, field]) => make("label", {}, name + " ", field)),
      make("button", { onclick: send }, word("send")), stop("A"), stop("B"));
  }

  buildOutputs() {
    this.outputs = OUTPUTS.map((output) => make("button", { onclick: () =>
      this.call("cib.do", { outputs: { [output]: this.state.do_register >> (output - 1) & 1 ? 0 : 1 } }) }, "DO" + output));
    this.duties = OUTPUTS.map((output) => {
      const range = make("input", { type: "range", min: 0, max: 10000, step: 1, "aria-label": `PWM ${output}` });
      const text = make("output");
      range.onchange = () => this.call("cib.pwm", { output, duty: Number(range.value) });
      return { range, text, element: make("label", {}, `PWM${output} `, range, text) };
    });
    return make("div", {}, make("div", { class: "front" }, group(word("cib-register"), this.outputs)),
      make("div", { class: "row duties" }, ...this.duties.map((duty) => duty.element)));
  }

  // What a host proposes, and what counts since the last APPLY.
  buildConfiguration() {
    this.area = make("textarea", { class: "plain", spellcheck: "false", "aria-label": word("cib-config") });
    this.area.value = this.text;
    this.area.oninput = () => { this.text = this.area.value; };
    this.wrong = make("p", { class: "note" });
    const put = async () => {
      try {
        this.showConfiguration(await this.call("cib.config.put", { setup: JSON.parse(this.area.value) }));
      } catch (error) {
        write(this.result, String(error.message));
        this.result.classList.add("wrong");
      }
    };
    const ask = (method) => async () => this.showConfiguration(await this.call(method));
    return make("section", {}, make("h3", {}, word("cib-config")), make("div", { class: "row" },
      make("button", { onclick: ask("cib.config") }, word("pmc-read")), make("button", { onclick: put }, word("pmc-write")),
      make("button", { onclick: ask("cib.apply") }, word("cib-apply"))), this.area, this.wrong);
  }

  showConfiguration(answer) {
    if (answer.error)
      return;
    this.area.value = this.text = JSON.stringify(answer.proposal, null, 2);
    const same = JSON.stringify(answer.counts) === JSON.stringify(answer.proposal);
    const text = word(same ? "cib-counts" : "cib-proposal");
    write(this.wrong, answer.wrong ? word("cib-wrong", answer.result, answer.wrong) : text);
    this.wrong.classList.toggle("wrong", Boolean(answer.wrong));
  }

  show(state) {
    this.state = state;
    if (!this.drives)
      this.build();
    this.drives.forEach((drive, at) => {
      const motor = state.motors[at];
      FIELDS.forEach((field, column) => write(drive.cells[column], String(motor[field] ?? "–")));
      BITS.forEach((bit, number) => light(drive.bits[number], Boolean(motor.mcstat >> number & 1), bit.toUpperCase()));
      drive.phases.forEach((element, phase) => {
        const bit = phase + 4 * at, minus = state.do >>> (8 + bit) & 1;
        write(element, `DO${bit + 1}${minus ? "−" : ""}`);
        light(element, Boolean(state.do >>> bit & 1) || Boolean(minus), `DO${bit + 1}${minus ? " −" : ""}`);
      });
    });
    this.outputs.forEach((button, at) => button.setAttribute("aria-pressed", String(Boolean(state.do_register >> at & 1))));
    this.duties.forEach((duty, at) => {
      const value = state.pwm?.[at] ?? 0;
      if (!duty.range.matches(":active"))
        duty.range.value = value;
      write(duty.text, `${(value / 100).toFixed(2)} %`);
    });
  }
}
