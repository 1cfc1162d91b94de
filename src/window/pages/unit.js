// SPDX-License-Identifier: MIT
// One virtual unit: its front, its motors, their curves, the axes of its plant.
import { word } from "./words.js";
import { Graph } from "./graph.js";
import { call } from "./link.js";

const PLANT_MS = 250;

function make(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes))
    key.startsWith("on") ? element.addEventListener(key.slice(2), value) : element.setAttribute(key, value);
  element.append(...children);
  return element;
}

const two = (number) => String(number).padStart(2, "0");

function group(title, children) {
  return make("fieldset", {}, make("legend", {}, title), ...children);
}

function lamp(text) {
  return make("span", { class: "lamp", role: "img" }, text);
}

function light(element, on, name) {
  element.classList.toggle("lit", on);
  element.setAttribute("aria-label", `${name} ${on ? 1 : 0}`);
}

export class UnitView {
  constructor(name, act) {
    this.name = name;
    this.act = (method, params) => act(method, { unit: name, ...params });
    this.element = make("section", { class: "unit" });
    this.axes = [];
    this.plantAsked = 0;
    this.build();
  }

  // All of it anew, in the present language.
  build() {
    const title = make("h2", {}, `${word("unit")} ${this.name}`);
    const bits = (from, to, of) => Array.from({ length: to - from + 1 }, (_, at) => of(from + at));
    this.power = make("button", { onclick: () => this.act("power", { on: !this.state?.powered }) }, word("power"));
    this.reset = make("button", { onclick: () => this.act("reset", {}) }, word("reset"));
    this.leds = bits(1, 4, (motor) => lamp(String(motor)));
    this.s1 = bits(0, 3, (bit) => make("button", { onclick: () => this.flip(bit) }, String(bit + 1)));
    this.s1Group = group("", this.s1);
    this.di = bits(1, 8, (input) => make("button", { onclick: () => this.setInput(input) }, two(input)));
    this.do = bits(1, 8, (output) => lamp(two(output)));
    this.var = bits(80, 95, (variable) => lamp(String(variable)));
    const front = make("div", { class: "front" }, group(word("power"), [this.power, this.reset]), group("LED", this.leds), this.s1Group,
      group("DI", this.di), group("DO", this.do), group("VAR", this.var));
    const heads = ["motor", "state", "command", "waits", "position", "true-position", "speed", "loops", "guards"];
    this.rows = bits(1, 4, () => heads.map(() => make("td")));
    const table = make("table", {}, make("thead", {}, make("tr", {}, ...heads.map((head) => make("th", { scope: "col" }, word(head))))),
      make("tbody", {}, ...this.rows.map((cells) => make("tr", {}, ...cells))));
    const canvas = make("canvas", { class: "graph", role: "img", "aria-label": word("speed-graph") });
    const old = this.graph;
    this.graph = new Graph(canvas, 2);
    if (old)
      this.graph.points = old.points;
    this.plant = make("div");
    this.axes = [];
    this.element.replaceChildren(title, front, make("div", { class: "motors", tabindex: "0", role: "group", "aria-label": title.textContent },
      table), canvas, this.plant);
    if (this.state)
      this.show(this.state);
  }

  flip(bit) {
    const node = ((this.state.switch - 1) ^ (1 << bit)) + 1;
    this.act("switch", { node });
  }

  setInput(input) {
    this.act("di.set", { di: { [input]: this.state.di >> (input - 1) & 1 ? 0 : 1 } });
  }

  show(state) {
    this.state = state;
    const pressed = (button, on) => button.setAttribute("aria-pressed", String(Boolean(on)));
    this.element.classList.toggle("off", !state.powered);
    pressed(this.power, state.powered);
    this.reset.disabled = !state.powered;
    this.s1Group.firstChild.textContent = word("power-up", state.switch);
    this.s1.forEach((button, bit) => pressed(button, (state.switch - 1) >> bit & 1));
    this.di.forEach((button, bit) => pressed(button, state.di >> bit & 1));
    this.do.forEach((element, bit) => light(element, Boolean(state.do >> bit & 1), `DO ${two(bit + 1)}`));
    this.var.forEach((element, bit) => light(element, Boolean(state.var >> bit & 1), `VAR ${80 + bit}`));
    state.motors.forEach((motor, at) => this.showMotor(motor, at, state.t_us));
    if (state.motors.some((motor) => motor.true_position !== null))
      this.askPlant();
    else if (this.axes.length > 0)
      this.showPlant(null);
  }

  showMotor(motor, at, t_us) {
    const loops = motor.loops.map((loop) => `L@${loop.start}: ${loop.left}`), calls = motor.calls.map((place) => `→${place}`);
    const guards = Object.entries(motor.guards).filter(([, input]) => input !== null).map(([kind, input]) => kind.toUpperCase() + two(input));
    const texts = [
      motor.motor, motor.fault ? `${motor.state}: ${motor.fault}` : motor.state,
      motor.command ? `${motor.index}/${motor.memory.commands}: ${motor.command}` : "–", motor.waits_for ?? "–", motor.position,
      motor.true_position ?? "–", motor.speed, [...loops, ...calls].join("\n") || "–", guards.join(" ") || "–",
    ];
    texts.forEach((text, column) => { this.rows[at][column].textContent = String(text); });
    light(this.leds[at], motor.lit, `LED ${at + 1}`);
    this.graph.add(0, at, t_us / 1000, motor.forward || motor.speed === 0 ? motor.speed : -motor.speed);
    this.graph.add(1, at, t_us / 1000, motor.position);
  }

  // ---- Plant ----

  async askPlant() {
    const now = performance.now();
    if (now - this.plantAsked < PLANT_MS) {
      clearTimeout(this.plantLater);
      this.plantLater = setTimeout(() => this.askPlant(), PLANT_MS);
      return;
    }
    this.plantAsked = now;
    const answer = await call("plant.get", { unit: this.name });
    if (!answer.error)
      this.showPlant(answer.plant ?? null);
  }

  showPlant(plant) {
    const motors = plant?.motors ?? [];
    if (motors.map((one) => one.motor).join() !== this.axes.map((axis) => axis.motor).join())
      this.buildAxes(motors);
    this.axes.forEach((axis, at) => this.showAxis(axis, motors[at], (plant.switches ?? []).filter((one) => one.motor === axis.motor)));
  }

  buildAxes(motors) {
    this.axes = motors.map(({ motor }) => {
      const set = (params) => this.act("plant.set", { motor, ...params });
      const range = make("input", { type: "range", step: "1", "aria-label": word("axis", motor) });
      const check = (name, key) => {
        const box = make("input", { type: "checkbox", onchange: () => set({ [key]: box.checked }) });
        return [box, make("label", { class: "check" }, box, " ", word(name))];
      };
      const [jammed, jammedLabel] = check("jammed", "jammed"), [lead, leadLabel] = check("lead", "missing_lead");
      const text = make("output"), switches = make("span", { class: "row" });
      range.oninput = () => set({ position: Number(range.value) });
      const element = make("div", { class: "axis" }, make("span", {}, word("axis", motor)), range, text, jammedLabel, leadLabel, switches);
      return { motor, element, range, jammed, lead, text, switches, low: -1000, high: 1000 };
    });
    this.plant.replaceChildren(...this.axes.map((axis) => axis.element));
  }

  showAxis(axis, motor, switches) {
    while (motor.true_position < axis.low) // with room beyond, to drag it there
      axis.low *= 2;
    while (motor.true_position > axis.high)
      axis.high *= 2;
    axis.range.min = axis.low;
    axis.range.max = axis.high;
    if (document.activeElement !== axis.range || !axis.range.matches(":active"))
      axis.range.value = motor.true_position;
    axis.jammed.checked = motor.jammed;
    axis.lead.checked = motor.missing_lead;
    axis.text.textContent = `${motor.true_position} (${motor.lost})`;
    while (axis.switches.children.length < switches.length)
      axis.switches.append(lamp(""));
    switches.forEach((one, at) => {
      axis.switches.children[at].textContent = `DI ${two(one.input)}`;
      light(axis.switches.children[at], one.actuated, `DI ${two(one.input)}`);
    });
  }
}
