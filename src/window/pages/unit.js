// SPDX-License-Identifier: MIT
// One virtual unit: its front, its motors with their programs, their curves, the axes of its plant. What a unit of this device
// has comes from `device` and `state` of the control socket (docs/CONTROL.md).
import { word } from "./words.js";
import { Axis } from "./axis.js";
import { CibPanel } from "./cib.js";
import { CncPanel } from "./cnc.js";
import { Graph } from "./graph.js";
import { Listing } from "./listing.js";
import { call } from "./link.js";
import { group, lamp, light, make, two, write } from "./make.js";
import { PmcPanel } from "./pmc.js";

const PLANT_MS = 250;

const range = (from, count, of) => Array.from({ length: count }, (_, at) => of(from + at));

// Members of a state that are shown elsewhere, or that say nothing to people.
const SHOWN = new Set(["t_us", "motors", "di", "do", "var", "unit", "node", "switch", "powered", "since_us", "clock", "line",
  "counters"]);
const MOTOR_SHOWN = new Set(["motor", "position", "state", "index", "led", "fault", "true_position", "command", "waits_for",
  "lit", "speed", "steps", "forward", "stopping", "held", "guards", "profile", "parameters", "functions", "loops", "calls",
  "memory", "slot"]);

// Devices with a panel of their own; it shows what else their states tell.
const panels = { "pmc-1hs": PmcPanel, "pmc-2hs": PmcPanel, cib: CibPanel, cnc872: CncPanel };

const plain = (value) => typeof value === "string" ? value : value === null ? "–" : JSON.stringify(value);

export class UnitView {
  constructor(name, device, act) {
    this.name = name;
    this.device = { axes: 4, inputs: 8, outputs: 8, variables: 16, first_variable: 80, addresses: 16, program: 700, ...device };
    this.act = async (method, params) => {
      const answer = await act(method, { unit: name, ...params });
      if (answer.plant)
        this.showPlant(answer.plant);
      return answer;
    };
    this.element = make("section", { class: "unit" });
    this.axes = [];
    this.plantAsked = 0;
    const Panel = panels[this.device.name];
    this.panel = Panel ? new Panel(name, this.act) : null;
    this.listing = this.device.program > 0 && !Panel ? new Listing(name) : null;
    this.build();
  }

  // All of it anew, in the present language.
  build() {
    const { device } = this, title = make("h2", {}, `${word("unit")} ${this.name}`);
    this.power = make("button", { onclick: () => this.act("power", { on: !this.state?.powered }) }, word("power"));
    this.reset = make("button", { onclick: () => this.act("reset", {}) }, word("reset"));
    this.leds = range(1, device.axes, (motor) => lamp(String(motor)));
    this.di = range(1, device.inputs, (input) => make("button", { onclick: () => this.setInput(input) }, this.inputName(input)));
    this.do = range(1, device.outputs, (output) => lamp(this.outputName(output)));
    this.var = range(device.first_variable, device.variables, (variable) => lamp(String(variable)));
    const own = Boolean(this.panel); // it shows what LEDs and variables would by name
    const bits = [["DI", this.di], ["DO", this.do], ["VAR", own ? [] : this.var]].filter(([, list]) => list.length > 0);
    const front = make("div", { class: "front" }, group(word("power"), [this.power, this.reset]),
      ...(own ? [] : [group("LED", this.leds)]), this.buildAddress(), ...bits.map(([name, list]) => group(name, list)));
    const canvas = this.panel?.curves ? null : this.buildGraph();
    this.plant = make("div");
    this.axes = [];
    this.more = make("dl", { class: "more" });
    this.listing?.showWords();
    this.panel?.build(device.axes);
    const motors = make("div", { class: "motors", tabindex: "0", role: "group", "aria-label": title.textContent });
    motors.append(this.buildTable());
    const inside = this.panel ? [this.panel.element] : [motors, this.more, this.listing?.element].filter(Boolean);
    this.element.replaceChildren(title, front, ...inside, ...(canvas ? [canvas] : []), this.plant);
    if (this.state)
      this.show(this.state);
  }

  buildGraph() {
    const canvas = make("canvas", { class: "graph", role: "img", "aria-label": word("speed-graph") }), old = this.graph;
    this.graph = new Graph(canvas, 2, this.device.axes);
    this.graph.titles = [word("speed"), word("position")];
    if (old)
      this.graph.take(old);
    return canvas;
  }

  inputName(input) { return this.device.input_names?.[input - 1] ?? two(input); }
  outputName(output) { return this.device.output_names?.[output - 1] ?? two(output); }

  // The address switch: S1 with four levers, or a number.
  buildAddress() {
    const { addresses } = this.device;
    const lever = (bit) => make("button", { onclick: () => this.flip(bit) }, String(bit + 1));
    this.s1 = addresses === 16 && !this.panel ? range(0, 4, lever) : [];
    this.address = make("input", { type: "number", min: 1, max: addresses, "aria-label": word("address") });
    this.address.onchange = () => this.act("switch", { node: Number(this.address.value) });
    this.s1Group = group("", this.s1.length > 0 ? this.s1 : [this.address]);
    this.s1Group.hidden = addresses <= 1;
    return this.s1Group;
  }

  buildTable() {
    this.heads = ["motor", "state", "command", "waits", "position", "true-position", "speed", "loops", "guards"];
    if (this.device.program === 0)
      this.heads = this.heads.filter((head) => !["command", "loops", "guards"].includes(head));
    this.rows = range(1, this.device.axes, () => this.heads.map(() => make("td")));
    const heads = make("tr", {}, ...this.heads.map((head) => make("th", { scope: "col" }, word(head))));
    return make("table", {}, make("thead", {}, heads), make("tbody", {}, ...this.rows.map((cells) => make("tr", {}, ...cells))));
  }

  flip(bit) {
    const node = ((this.state.switch - 1) ^ (1 << bit)) + 1;
    this.act("switch", { node });
  }

  setInput(input) {
    this.act("di.set", { di: { [input]: this.state.di >>> (input - 1) & 1 ? 0 : 1 } });
  }

  show(state) {
    this.state = state;
    const pressed = (button, on) => button.setAttribute("aria-pressed", String(Boolean(on)));
    this.element.classList.toggle("off", !state.powered);
    pressed(this.power, state.powered);
    this.reset.disabled = !state.powered;
    write(this.s1Group.firstChild, word(this.s1.length > 0 ? "power-up" : "address-up", state.switch));
    this.s1.forEach((button, bit) => pressed(button, (state.switch - 1) >> bit & 1));
    if (document.activeElement !== this.address)
      this.address.value = state.switch;
    this.di.forEach((button, bit) => pressed(button, state.di >>> bit & 1));
    this.do.forEach((element, bit) => light(element, Boolean(state.do >>> bit & 1), `DO ${this.outputName(bit + 1)}`));
    this.var.forEach((element, bit) => light(element, Boolean(state.var >>> bit & 1), `VAR ${this.device.first_variable + bit}`));
    if (this.panel)
      this.panel.show(state);
    else
      this.showMotors(state);
    if (this.graph)
      state.motors.forEach((motor, at) => this.drawMotor(motor, at, state.t_us));
    this.listing?.show(state);
    if (state.motors.some((motor) => motor.true_position !== null))
      this.askPlant();
    else if (this.axes.length > 0)
      this.showPlant(null);
  }

  showMotors(state) {
    state.motors.forEach((motor, at) => this.showMotor(motor, at));
    this.showMore(state);
  }

  showMotor(motor, at) {
    const loops = (motor.loops ?? []).map((loop) => `L@${loop.start}: ${loop.left}`);
    const calls = (motor.calls ?? []).map((place) => `→${place}`);
    const guards = Object.entries(motor.guards ?? {}).filter(([, input]) => input !== null)
      .map(([kind, input]) => kind.toUpperCase() + two(input));
    const texts = {
      motor: motor.motor, state: motor.fault ? `${motor.state}: ${motor.fault}` : motor.state,
      command: motor.command ? `${motor.index}/${motor.memory?.commands ?? "?"}: ${motor.command}` : "–",
      waits: motor.waits_for ?? "–",
      position: motor.position, "true-position": motor.true_position ?? "–", speed: motor.speed ?? "–",
      loops: [...loops, ...calls].join("\n") || "–", guards: guards.join(" ") || "–",
    };
    this.heads.forEach((head, column) => write(this.rows[at][column], String(texts[head])));
    light(this.leds[at], motor.lit ?? motor.led === "on", `LED ${at + 1}`);
  }

  drawMotor(motor, at, t_us) {
    const speed = motor.speed ?? 0;
    this.graph.add(0, at, t_us / 1000, motor.forward || speed === 0 ? speed : -speed);
    this.graph.add(1, at, t_us / 1000, motor.position);
  }

  // What else the device tells of itself and of its motors.
  showMore(state) {
    const parts = Object.entries(state).filter(([key]) => !SHOWN.has(key)).map(([key, value]) => [key, plain(value)]);
    for (const motor of state.motors)
      for (const [key, value] of Object.entries(motor))
        if (!MOTOR_SHOWN.has(key))
          parts.push([`${key} ${motor.motor}`, plain(value)]);
    while (this.more.children.length > parts.length)
      this.more.lastChild.remove();
    parts.forEach(([key, text], at) => {
      if (!this.more.children[at])
        this.more.append(make("div", {}, make("dt"), make("dd")));
      write(this.more.children[at].firstChild, key);
      write(this.more.children[at].lastChild, text);
    });
  }

  // ---- Plant ----

  lookAtPlant() {
    if (this.axes.length > 0)
      this.askPlant();
  }

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
    const motors = plant?.motors ?? [], key = (list) => list.map((one) => `${one.motor}/${one.turn ?? ""}`).join();
    if (key(motors) !== key(this.axes)) {
      const nameOf = (input) => this.device.input_names?.[input - 1] ?? `DI ${two(input)}`;
      this.axes = motors.map(({ motor, turn }) => new Axis(motor, turn, this.act, nameOf));
      this.plant.replaceChildren(...this.axes.map((axis) => axis.element));
    }
    this.axes.forEach((axis, at) => axis.show(motors[at], (plant.switches ?? []).filter((one) => one.motor === axis.motor)));
  }
}
