// SPDX-License-Identifier: MIT
// The programs of a unit's motors as listings, with the command that each motor executes highlighted in its place.
import { call } from "./link.js";
import { word } from "./words.js";
import { make, write } from "./make.js";

const ASK_MS = 250;
const MOTIONS = /^[RGH().E]/; // after these comes a new line

export class Listing {
  constructor(unit) {
    this.unit = unit;
    this.motors = new Map();
    this.element = make("details", { class: "programs" }, make("summary", {}, word("programs")));
    this.boxes = make("div", { class: "listings" });
    this.element.append(this.boxes);
    this.element.ontoggle = () => this.state && this.show(this.state);
  }

  // What changes when the memory may have changed: a power-up, a request, the number of commands.
  show(state) {
    this.state = state;
    if (!this.element.open)
      return;
    for (const motor of state.motors) {
      const one = this.of(motor.motor);
      const version = [state.since_us, state.counters?.requests, motor.memory?.commands].join();
      if (version !== one.version)
        this.ask(motor.motor, one, version);
      this.mark(one, motor);
    }
  }

  of(number) {
    if (!this.motors.has(number)) {
      const title = make("h3", {}, `${word("motor")} ${number}`);
      const text = make("div", { class: "listing", tabindex: "0", role: "group", "aria-label": `${word("programs")} ${number}` });
      const box = make("section", {}, title, text);
      this.motors.set(number, { box, text, version: null, commands: [], first: 1, of: 1 });
      this.boxes.append(box);
    }
    return this.motors.get(number);
  }

  async ask(number, one, version) {
    const now = performance.now();
    if (one.asking || now - (one.asked ?? -ASK_MS) < ASK_MS) {
      clearTimeout(one.later);
      one.later = setTimeout(() => this.show(this.state), ASK_MS);
      return;
    }
    one.asked = now;
    one.asking = true;
    const answer = await call("motor.program", { unit: this.unit, motor: number });
    one.asking = false;
    one.version = version;
    Object.assign(one, { first: answer.first ?? 1, of: answer.of ?? 1, marked: null });
    if (answer.error || answer.commands.length === 0)
      one.text.replaceChildren(answer.error ?? word("no-program"));
    else if (answer.commands.join(" ") !== one.commands.join(" ") || one.text.children.length === 0)
      one.text.replaceChildren(...answer.commands.flatMap((each) => [make("span", {}, each), MOTIONS.test(each) ? "\n" : " "]));
    one.commands = answer.commands ?? [];
    const motor = this.state.motors.find((each) => each.motor === number);
    if (motor)
      this.mark(one, motor);
  }

  mark(one, motor) {
    const at = motor.index > 0 ? (motor.index - one.first + one.of) % one.of : -1;
    if (one.marked === at)
      return;
    for (const old of one.text.querySelectorAll("[aria-current]"))
      old.removeAttribute("aria-current");
    const now = one.text.querySelectorAll("span")[at];
    one.marked = at;
    if (!now)
      return;
    now.setAttribute("aria-current", "step");
    if (now.offsetTop < one.text.scrollTop || now.offsetTop + now.offsetHeight > one.text.scrollTop + one.text.clientHeight)
      one.text.scrollTop = now.offsetTop - one.text.clientHeight / 2;
  }

  // In the present language.
  showWords() {
    write(this.element.firstChild, word("programs"));
    for (const [number, one] of this.motors)
      write(one.box.firstChild, `${word("motor")} ${number}`);
  }
}
