// SPDX-License-Identifier: MIT
// Cells between CNC system and PLC program as a table: found by a part of their name, read ten times a second, marked when they
// change, set where that is allowed. And the mechanisms of the PLC program as lamps. By cnc.cells, cnc.get and cnc.set. What was
// otherwise between two readings, be it for one T, is shown for a moment: the emulator collects it (subscribe, collected).
import { call } from "./link.js";
import { word } from "./words.js";
import { lamp, light, make, makeScrolled, write } from "./make.js";

const NOTHING = "–"; // where a value is not known
const READ_MS = 100;
const MARKED_MS = 1500;
const PULSE_MS = 300;
const COLLECT_MAX = 64; // cells of a subscription
const FIND_MS = 150;
const FOUND_MAX = 60; // names offered at a time
const FIRST = ["PO_F", "PO_STOP", "STOP_REQ"];
const STORED = "cells";

function readStored() {
  try {
    const names = JSON.parse(localStorage.getItem(STORED));
    return Array.isArray(names) && names.every((name) => typeof name === "string") ? names : FIRST;
  } catch {
    return FIRST;
  }
}

// 17, -3, 2.5, 95h, 0x95 as a number; null: it is none. What a double cannot hold goes as it is written.
export function readValue(text) {
  const written = text.trim(), hex = /^(?:0x([0-9a-f]+)|([0-9][0-9a-f]*)h)$/i.exec(written);
  if (hex)
    return parseInt(hex[1] ?? hex[2], 16);
  const value = Number(written);
  if (written === "" || !Number.isFinite(value))
    return null;
  return Number.isInteger(value) && !Number.isSafeInteger(value) && JSON.rawJSON ? JSON.rawJSON(written) : value;
}

export class Cells {
  // set(cells): cnc.set, with what is refused shown.
  constructor(unit, set) {
    this.unit = unit;
    this.set = set;
    this.rows = readStored().map((name) => ({ name }));
    this.mechanisms = [];
    this.element = make("section", { class: "cells" });
    this.lamps = make("div", { class: "front" });
    this.isReading = false;
    this.wanted = "";
  }

  // ---- Which ----

  build() {
    this.wish = make("input", { list: "cell-names", autocomplete: "off", spellcheck: "false", "aria-label": word("cnc-cell") });
    this.names = make("datalist", { id: "cell-names" });
    this.note = make("p", { class: "note", role: "status" });
    this.body = make("tbody");
    this.wish.oninput = () => this.find();
    const form = make("form", { class: "row" }, make("label", { class: "wide" }, word("cnc-cell") + " ", this.wish), this.names,
      make("button", {}, word("cnc-add")));
    form.onsubmit = (event) => {
      event.preventDefault();
      this.add(this.wish.value.split(/[\s,;]+/).filter(Boolean));
    };
    const heads = ["cnc-cell", "cnc-type", "cnc-value", "cnc-remove"].map((name) => make("th", { scope: "col" }, word(name)));
    const table = make("table", { class: "cells" }, make("thead", {}, make("tr", {}, ...heads)), this.body);
    this.element.replaceChildren(make("h3", {}, word("cnc-cells")), form, this.note, makeScrolled(table));
    this.showRows();
    this.showMechanisms();
    this.read();
  }

  // Another emulator, or the same one again: what it has.
  async begin() {
    const answer = await call("cnc.cells", { unit: this.unit, section: "mechanism" });
    this.mechanisms = (answer.cells ?? []).map(({ name }) => ({ name }));
    this.collected = null;
    this.showMechanisms();
    for (const row of this.rows)
      row.type = row.error = row.shown = undefined;
    await Promise.all(this.rows.map((row) => this.learn(row)));
    this.showRows();
  }

  // Names that have what is being typed, after a pause.
  find() {
    clearTimeout(this.later);
    const wanted = this.wanted = this.wish.value.trim();
    this.later = setTimeout(async () => {
      const answer = await call("cnc.cells", { unit: this.unit, search: wanted, limit: FOUND_MAX });
      if (wanted !== this.wanted || !answer.cells)
        return;
      this.names.replaceChildren(...answer.cells.map(({ name, type, access, section }) =>
        make("option", { value: name }, `${type} ${access} ${section}`)));
      write(this.note, answer.cells.length === 0 ? word("cnc-none") : answer.more > 0 ? word("cnc-found-more",
        answer.cells.length, answer.more) : word("cnc-found", answer.cells.length));
      this.note.classList.remove("wrong");
    }, FIND_MS);
  }

  // What a cell is; of an operand, such as WORD.BZH09+1, the cell that it is a part of.
  async learn(row) {
    const [, type, name] = /^(?:(BYTE|WORD|DWRD|QWRD|REAL)\.)?\(?(.*)$/i.exec(row.name), search = /^[^+).[]*/.exec(name)[0];
    const [found, tried] = await Promise.all([call("cnc.cells", { unit: this.unit, search, limit: 1000 }),
      call("cnc.get", { unit: this.unit, cells: [row.name] })]);
    const cells = (found.cells ?? []).map((cell) => ({ ...cell, lower: cell.name.toLowerCase() }));
    const cell = cells.find(({ lower }) => lower === name.toLowerCase())
      ?? cells.find(({ lower }) => lower.startsWith(search.toLowerCase()));
    row.error = tried.error;
    row.type = type?.toUpperCase() ?? cell?.type ?? "";
    row.isFixed = cell?.access !== "rw" || /^BLK\[/i.test(name);
  }

  async add(names) {
    clearTimeout(this.later); // what has been found says nothing any more
    this.wanted = null;
    const isNew = (name) => !this.rows.some((row) => row.name.toLowerCase() === name.toLowerCase());
    const found = [...new Set(names)].map((name) => ({ name }));
    await Promise.all(found.map((row) => this.learn(row)));
    this.rows.push(...found.filter((row) => !row.error && isNew(row.name)));
    const wrong = found.filter((row) => row.error); // they stay in the field, to be corrected
    write(this.note, wrong[0]?.error ?? "");
    this.note.classList.toggle("wrong", wrong.length > 0);
    this.wish.value = wrong.map(({ name }) => name).join(" ");
    this.showRows();
    this.store();
  }

  remove(row) {
    this.rows = this.rows.filter((one) => one !== row);
    this.showRows();
    this.store();
    this.wish.focus();
  }

  store() {
    try {
      localStorage.setItem(STORED, JSON.stringify(this.rows.map(({ name }) => name)));
    } catch { /* not allowed: the table is as at first next time */ }
  }

  // ---- Values ----

  // The table, made anew: what it showed is kept, so that nothing is empty or without a name until it is read again.
  showRows() {
    for (const row of this.rows) {
      const last = row.shown;
      row.shown = undefined;
      row.value = make("td", { class: "value" });
      const remove = make("button", { "aria-label": `${word("cnc-remove")} ${row.name}`, onclick: () => this.remove(row) }, "×");
      row.control = row.isFixed || row.error ? null : row.type === "BIT" ? this.makeBit(row) : this.makeField(row);
      row.value.append(...(row.control ? [row.control] : []));
      row.line = make("tr", {}, make("th", { scope: "row" }, row.name), make("td", {}, row.type ?? ""), row.value,
        make("td", {}, remove));
      if (row.error)
        row.value.textContent = row.error;
      else
        this.showValue(row, last ?? null);
      row.shown = last;
    }
    this.body.replaceChildren(...this.rows.map((row) => row.line));
  }

  makeBit(row) {
    return make("button", { onclick: () => this.set({ [row.name]: row.shown ? 0 : 1 }) });
  }

  makeField(row) {
    const field = make("input", { inputmode: "numeric", size: 12, spellcheck: "false", "aria-label": row.name });
    field.onkeydown = (event) => {
      if (event.key === "Escape") {
        field.value = String(row.shown ?? NOTHING);
        field.blur();
      }
      if (event.key !== "Enter")
        return;
      const value = readValue(field.value);
      field.classList.toggle("wrong", value === null);
      if (value !== null)
        this.set({ [row.name]: value });
      field.select();
    };
    field.onblur = () => {
      field.classList.remove("wrong");
      field.value = String(row.shown ?? NOTHING);
    };
    return field;
  }

  showValue(row, value) {
    if (value === row.shown)
      return;
    const isFirst = row.shown === undefined;
    row.shown = value;
    this.showText(row, String(value ?? NOTHING));
    if (!isFirst)
      this.mark(row);
  }

  showText(row, text) {
    if (!row.control)
      write(row.value, text);
    else if (row.type === "BIT") {
      write(row.control, text);
      row.control.setAttribute("aria-label", `${row.name} ${text}`);
      row.control.setAttribute("aria-pressed", String(text === "1"));
    } else if (document.activeElement !== row.control)
      row.control.value = text;
  }

  mark(row) {
    row.line.classList.add("changed");
    clearTimeout(row.marked);
    row.marked = setTimeout(() => row.line.classList.remove("changed"), MARKED_MS);
  }

  // It was otherwise since the last reading, and is again as it was.
  showPulse(row) {
    if (row.type !== "BIT") {
      this.mark(row);
      return;
    }
    this.showText(row, String(1 - row.shown));
    row.line.classList.add("pulsed");
    this.mark(row);
    clearTimeout(row.pulsed);
    row.pulsed = setTimeout(() => {
      row.line.classList.remove("pulsed");
      this.showText(row, String(row.shown));
    }, PULSE_MS);
  }

  lightMechanism(one, isLit) { light(one.lamp, isLit, one.name); }

  pulseMechanism(one) {
    this.lightMechanism(one, true);
    clearTimeout(one.pulsed);
    one.pulsed = setTimeout(() => {
      one.pulsed = null;
      this.lightMechanism(one, Boolean(one.shown));
    }, PULSE_MS);
  }

  showMechanisms() {
    for (const one of this.mechanisms) {
      one.lamp = lamp(one.name);
      light(one.lamp, Boolean(one.shown), one.name);
    }
    this.lamps.hidden = this.mechanisms.length === 0;
    this.lamps.replaceChildren(make("fieldset", {}, make("legend", {}, word("cnc-mechanisms")),
      ...this.mechanisms.map((one) => one.lamp)));
  }

  isSeen() { return !document.hidden && this.element.offsetParent !== null; }

  // Again and again while the table is seen, one request at a time.
  async read() {
    if (this.isReading)
      return;
    this.isReading = true;
    while (this.element.isConnected || !this.wasShown) {
      this.wasShown ||= this.element.isConnected;
      const rows = this.rows.filter((row) => row.type !== undefined && !row.error);
      const names = [...new Set([...this.mechanisms, ...rows].map(({ name }) => name))];
      const isSeen = this.isSeen() && names.length > 0;
      if (isSeen) {
        const collected = await this.readCollected(rows);
        const answer = await call("cnc.get", { unit: this.unit, cells: names });
        this.take(answer, rows, this.wasSeen ? collected : {});
      }
      this.wasSeen = isSeen;
      await new Promise((done) => setTimeout(done, READ_MS));
    }
    this.isReading = this.wasShown = false;
  }

  // What cells have been since the last call: {name: {value, changes, least, greatest}}. By one subscription.
  async readCollected(rows) {
    const names = [...new Set([...this.mechanisms, ...rows.filter(({ type }) => type !== "REAL")].map(({ name }) => name))]
      .slice(0, COLLECT_MAX);
    if (names.join() !== this.collected) {
      if (this.subscription)
        await call("unsubscribe", { subscription: this.subscription });
      this.collected = names.join();
      const answer = names.length > 0 ? await call("subscribe", { unit: this.unit, cells: names, collect: true }) : {};
      this.subscription = answer.subscription;
    }
    if (!this.subscription)
      return {};
    const answer = await call("collected", { subscription: this.subscription });
    if (!answer.cells)
      this.collected = this.subscription = undefined; // another connection
    return answer.cells ?? {};
  }

  take({ cells }, rows, collected) {
    for (const row of cells ? rows : []) {
      const before = row.shown, value = cells[row.name];
      if (value !== undefined)
        this.showValue(row, value);
      if (value === before && collected[row.name])
        this.showPulse(row);
    }
    for (const one of cells ? this.mechanisms : []) {
      one.shown = cells[one.name];
      if (!one.shown && collected[one.name]?.greatest === 1)
        this.pulseMechanism(one);
      else if (!one.pulsed || one.shown)
        this.lightMechanism(one, Boolean(one.shown));
    }
  }
}
