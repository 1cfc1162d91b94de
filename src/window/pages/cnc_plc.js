// SPDX-License-Identifier: MIT
// The PLC program of a CNC872: its text to be edited and loaded while it runs, and a listing of what runs, with the present value
// of the cell that each line names and marks where sections and mechanisms wait. By cnc.load and cnc.plc.
import { call } from "./link.js";
import { word } from "./words.js";
import { CncText } from "./cnc_text.js";
import { make, write } from "./make.js";

const READ_MS = 100;
const LINES_MAX = 3000; // of a listing
const LINES_ASKED = 500; // of an answer, at most

export class CncPlc {
  // load(text, name): cnc.load.
  constructor(unit, load) {
    this.unit = unit;
    this.text = new CncText(load, { name: "program.plc", title: "cnc-plc", loaded: "cnc-plc-loaded", part: "plc-program" });
    this.element = make("details", { class: "plc" });
    this.element.ontoggle = () => this.read();
    this.rows = [];
  }

  build() {
    this.text.build();
    this.registers = make("p", { class: "note" });
    this.list = make("div", { class: "listing plc", tabindex: "0", role: "group", "aria-label": word("cnc-plc") });
    const take = make("button", { onclick: () => this.text.setText(this.rows.map(({ text }) => text).join("\n")) },
      word("cnc-plc-take"));
    this.element.replaceChildren(make("summary", {}, word("cnc-plc-more")), make("div", { class: "columns" }, this.text.element,
      make("section", {}, make("div", { class: "row" }, take), this.registers, this.list)));
    this.rows = [];
    this.begin();
  }

  // Another program.
  begin() { this.isKnown = false; }

  // ---- The text ----

  showText(lines) {
    this.rows = lines.map(({ line, text, value }) => {
      const shown = make("span", { class: "value" }, value === undefined ? "" : String(value));
      const element = make("div", {}, make("span", { class: "number" }, String(line)), shown, make("code", {}, text));
      return { text, shown, element };
    });
    this.list.replaceChildren(...this.rows.map(({ element }) => element));
  }

  // All lines, part by part.
  async readText() {
    const lines = [];
    let answer;
    do {
      answer = await call("cnc.plc", { unit: this.unit, first: lines.length + 1, lines: LINES_ASKED });
      lines.push(...(answer.listing ?? []));
    } while (answer.listing?.length > 0 && lines.length < Math.min(answer.lines, LINES_MAX));
    this.isKnown = true;
    this.showText(lines.slice(0, LINES_MAX));
    if (answer.error)
      write(this.registers, answer.error);
    return !answer.error;
  }

  // ---- Values ----

  // The lines that are seen, from 1: [first, how many].
  seen() {
    const height = this.rows[0]?.element.offsetHeight || 1;
    const first = Math.floor(this.list.scrollTop / height);
    return [first + 1, Math.min(LINES_ASKED, Math.ceil(this.list.clientHeight / height) + 1)];
  }

  // Returns whether the lines are those that are shown.
  showValues(answer, first) {
    const rows = answer.listing.map((_, at) => this.rows[first - 1 + at]);
    if (answer.listing.some(({ text }, at) => rows[at] && rows[at].text !== text))
      return false;
    answer.listing.forEach(({ value }, at) => rows[at] && write(rows[at].shown, value === undefined ? "" : String(value)));
    const marked = new Set(answer.waits.map(({ line }) => line).concat(answer.halted ?? []));
    this.rows.forEach(({ element }, at) => {
      if (marked.has(at + 1))
        element.setAttribute("aria-current", "step");
      else
        element.removeAttribute("aria-current");
    });
    write(this.registers, [
      `T ${answer.t}  RLO ${answer.rlo}  DR ${answer.dr}  DR_REAL ${answer.dr_real}  BX ${answer.bx}`,
      ...Object.entries(answer.calls).map(([name, { last, most }]) => word("cnc-plc-calls", name, last, most)),
      ...answer.waits.map(({ name, line }) => word("cnc-plc-waits", name, line)),
      ...(answer.halted === null ? [] : [word("cnc-plc-halted", answer.halted)]),
      ...(answer.lines > LINES_MAX ? [word("cnc-plc-long", LINES_MAX)] : []),
    ].join("\n"));
    return true;
  }

  isSeen() { return this.element.open && !document.hidden && this.element.isConnected; }

  // Again and again while it is open, one request at a time.
  async read() {
    if (this.isReading)
      return;
    this.isReading = true;
    while (this.element.open && this.element.isConnected) {
      if (this.isSeen() && (this.isKnown || await this.readText()) && this.rows.length > 0) {
        const [first, lines] = this.seen(), answer = await call("cnc.plc", { unit: this.unit, first, lines });
        this.isKnown = Boolean(answer.listing) && this.showValues(answer, first);
      }
      await new Promise((done) => setTimeout(done, READ_MS));
    }
    this.isReading = false;
  }
}
