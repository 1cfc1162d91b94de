// SPDX-License-Identifier: MIT
// What the operator of a CNC872 has: START, STOP, RESET, mode, home search, pots, choice of a block, keys that move an axis,
// switches, keys of the hand-wheel panels, and a critical error to try. All of it by cnc.panel.
import { word } from "./words.js";
import { group, make, write } from "./make.js";
import { leave, makeHeld, releaseAll } from "./held.js";

const SWITCHES = ["rapid", "hand", "block_by_block", "m01", "indication", "simulation", "high_speed"];
const WORDS = ["P1", "P1_2", "P2", "P2_2"]; // of the keys of the two hand-wheel panels
const KEYS = 16;

export class CncKeys {
  // press(params, quiet): cnc.panel.
  constructor(unit, press) {
    this.unit = unit;
    this.press = press;
    this.signs = new Map(); // of each axis the keys that are held, the last one last
    this.bits = Object.fromEntries(WORDS.map((name) => [name, 0])); // keys that are held
    this.element = make("div", { class: "keys" });
    this.jog = make("div", { class: "row" });
    this.keptOn = false;
  }

  build() {
    releaseAll();
    this.element.replaceChildren(this.buildRun(), this.jog, this.buildSwitches(), this.buildMore());
  }

  button(text, params, attributes = {}) {
    return make("button", { ...attributes, onclick: () => this.press(params()) }, text);
  }

  number(name, least, most) {
    return make("input", { type: "number", value: 0, min: least, max: most, step: 1, "aria-label": name });
  }

  buildRun() {
    this.mode = make("select", { "aria-label": word("cnc-mode"), onchange: () => this.press({ mode: this.mode.value }) });
    this.mode.append(new Option(word("cnc-aut"), "aut"), new Option(word("cnc-manual"), "manual"));
    this.home = make("select", { "aria-label": word("cnc-axis") });
    this.pots = ["feed", "spindle"].map((name) => {
      const range = make("input", { type: "range", min: 0, max: 200, step: 1, "aria-label": word("cnc-pot-" + name) });
      range.oninput = () => this.press({ [name]: Number(range.value) }, true);
      return { name, range, text: make("output") };
    });
    const pots = this.pots.map(({ name, range, text }) => make("label", {}, word("cnc-pot-" + name) + " ", range, text));
    return make("div", { class: "row" }, this.button("START", () => ({ start: true }), { class: "start" }),
      this.button("STOP", () => ({ stop: true }), { class: "stop" }), this.button("RESET", () => ({ reset: true })),
      make("label", {}, word("cnc-mode") + " ", this.mode), make("label", {}, word("cnc-axis") + " ", this.home),
      this.button(word("cnc-home"), () => ({ home: this.home.value })), ...pots);
  }

  buildSwitches() {
    const change = (name) => () => this.press({ [name]: !this.panel[name] });
    this.switches = SWITCHES.map((name) => make("button", { onclick: change(name) }, word("cnc-" + name)));
    return group(word("cnc-switches"), this.switches);
  }

  // What is needed less often.
  buildMore() {
    const block = this.number(word("cnc-select-block"), 0, 999999), technology = make("input", { type: "checkbox", checked: "" });
    const critical = this.number(word("cnc-critical"), 0, 255);
    this.word = make("select", { "aria-label": word("cnc-keys"), onchange: () => { releaseAll(); this.showKeys(); } });
    this.word.append(...WORDS.map((name) => new Option("PTLTOC_" + name, name)));
    this.keep = make("input", { type: "checkbox", onchange: () => { this.keptOn = this.keep.checked; } });
    this.keep.checked = this.keptOn;
    this.pressed = Array.from({ length: KEYS }, (_, bit) =>
      makeHeld(String(bit), (on) => this.setKey(bit, on), { "aria-label": `${word("cnc-key")} ${bit}` }));
    const check = (box, text) => make("label", { class: "check" }, box, " " + text);
    return make("details", { class: "programs" }, make("summary", {}, word("cnc-more")),
      make("div", { class: "row" }, make("label", {}, word("cnc-select-block") + " ", block),
        check(technology, word("cnc-technology")),
        this.button(word("cnc-select"), () => ({ select: Number(block.value), technology: technology.checked })),
        make("label", {}, word("cnc-critical") + " ", critical),
        this.button(word("cnc-set"), () => ({ rtm: Number(critical.value) })),
        this.button(word("cnc-clear-critical"), () => ({ rtm: 0 }))),
      make("div", { class: "row" }, make("label", {}, word("cnc-keys") + " ", this.word), group("", this.pressed),
        check(this.keep, word("cnc-keep"))));
  }

  // ---- Keys that are held ----

  // What has to be let go if the page goes.
  leaveIfHeld() {
    const jog = Object.fromEntries([...this.signs].filter(([, signs]) => signs.length > 0).map(([name]) => [name, ""]));
    const keys = Object.fromEntries(WORDS.filter((name) => this.bits[name]).map((name) => [name, this.panel.keys[this.at(name)]
      & ~this.bits[name]]));
    const isHeld = Object.keys(jog).length + Object.keys(keys).length > 0;
    leave(isHeld ? "cnc.panel" : null, { unit: this.unit, jog, keys });
  }

  setJog(name, sign, on) {
    const signs = (this.signs.get(name) ?? []).filter((one) => one !== sign).concat(on ? [sign] : []);
    this.signs.set(name, signs);
    if (on)
      this.leaveIfHeld();
    this.press({ jog: { [name]: signs.at(-1) ?? "" } }, true);
    if (!on)
      this.leaveIfHeld();
  }

  at(name) { return WORDS.indexOf(name); }

  // A key of the hand-wheel panel chosen. "Keep pressed" makes it a switch.
  setKey(bit, on) {
    const name = this.word.value, mask = 1 << bit, before = this.panel.keys[this.at(name)];
    if (this.keptOn && !on)
      return;
    const after = this.keptOn ? before ^ mask : on ? before | mask : before & ~mask;
    if (!this.keptOn)
      this.bits[name] = on ? this.bits[name] | mask : this.bits[name] & ~mask;
    if (on)
      this.leaveIfHeld();
    this.panel.keys[this.at(name)] = after;
    this.showKeys();
    this.press({ keys: { [name]: after } }, true);
    if (!on)
      this.leaveIfHeld();
  }

  // ---- State ----

  showAxes(names) {
    releaseAll();
    this.home.replaceChildren(...names.map((name) => new Option(name)));
    this.jogs = names.flatMap((name) => ["-", "+"].map((sign) => ({ name, sign,
      button: makeHeld(name + (sign === "-" ? "−" : "+"), (on) => this.setJog(name, sign, on)) })));
    this.jog.replaceChildren(...this.jogs.map(({ button }) => button));
  }

  showKeys() {
    const value = this.panel.keys[this.at(this.word.value)];
    this.pressed.forEach((button, bit) => button.setAttribute("aria-pressed", String(Boolean(value >> bit & 1))));
  }

  show(panel) {
    this.panel = panel;
    this.switches.forEach((button, at) => button.setAttribute("aria-pressed", String(panel[SWITCHES[at]])));
    for (const { name, sign, button } of this.jogs)
      button.setAttribute("aria-pressed", String(panel.jog[name] === sign));
    this.showKeys();
    if (document.activeElement !== this.mode)
      this.mode.value = panel.mode;
    for (const { name, range, text } of this.pots) {
      if (!range.matches(":active"))
        range.value = panel[name];
      write(text, `${panel[name]} %`);
    }
  }
}
