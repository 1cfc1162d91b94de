// SPDX-License-Identifier: MIT
// An axis of a plant, drawn as what it is: a slide with its end stops, or a turntable; with the ranges of its switches. The
// carriage or the table is dragged with the mouse or by the slider below it.
import { word } from "./words.js";
import { make, makeSvg, lamp, light, write } from "./make.js";

const WIDTH = 640, EDGE = 20, TRACK = 34; // of a slide
const SIZE = 170, CENTRE = 85, RADIUS = 58; // of a turntable
const SEND_MS = 50; // between two positions while it is dragged

const whole = (value, turn) => ((value % turn) + turn) % turn;

export class Axis {
  // `nameOf` gives the name of an input.
  constructor(motor, turn, act, nameOf) {
    this.nameOf = nameOf;
    this.motor = motor;
    this.turn = turn;
    this.act = act;
    this.low = -1000;
    this.high = 1000;
    this.sent = 0;
    const set = (params) => this.act("plant.set", { motor, ...params });
    const check = (name, key) => {
      const box = make("input", { type: "checkbox", onchange: () => set({ [key]: box.checked }) });
      return [box, make("label", { class: "check" }, box, " ", word(name))];
    };
    this.picture = makeSvg("svg", { class: turn ? "turntable" : "slide", role: "img",
      viewBox: turn ? `0 0 ${SIZE} ${SIZE}` : `0 0 ${WIDTH} 70` });
    this.range = make("input", { type: "range", step: "1", "aria-label": word("axis", motor) });
    this.range.oninput = () => this.moveTo(Number(this.range.value), true);
    const [jammed, jammedLabel] = check("jammed", "jammed"), [lead, leadLabel] = check("lead", "missing_lead");
    Object.assign(this, { jammed, lead, text: make("output"), lamps: make("span", { class: "row" }) });
    const controls = make("div", { class: "row" }, this.range, this.text, jammedLabel, leadLabel, this.lamps);
    this.element = make("div", { class: "axis" }, make("h3", {}, word("axis", motor)), this.picture, controls);
    for (const name of ["pointerdown", "pointermove", "pointerup", "pointercancel"])
      this.picture.addEventListener(name, (event) => this.onPointer(name, event));
  }

  // The position below the mouse; of a turntable that of the present turn.
  positionAt(event) {
    const box = this.picture.getBoundingClientRect();
    if (!this.turn) {
      const part = ((event.clientX - box.left) / box.width * WIDTH - EDGE) / (WIDTH - 2 * EDGE);
      return Math.round(this.low + Math.min(1, Math.max(0, part)) * (this.high - this.low));
    }
    const angle = Math.atan2(event.clientX - box.left - box.width / 2, box.top + box.height / 2 - event.clientY);
    const turned = this.position - whole(this.position, this.turn);
    return turned + whole(Math.round(angle / (2 * Math.PI) * this.turn), this.turn);
  }

  onPointer(name, event) {
    if (name === "pointerdown") {
      this.picture.setPointerCapture(event.pointerId);
      this.dragged = true;
    }
    if (this.dragged && name !== "pointercancel")
      this.moveTo(this.positionAt(event), name !== "pointermove");
    if (name === "pointerup" || name === "pointercancel")
      this.dragged = false;
  }

  // Between the end stops: the emulator refuses anything beyond.
  moveTo(position, surely) {
    const now = performance.now();
    if (!surely && now - this.sent < SEND_MS)
      return;
    this.sent = now;
    const base = this.turn ? this.position - whole(this.position, this.turn) : 0;
    const wanted = this.turn && position >= 0 && position < this.turn ? base + position : position;
    this.act("plant.set", { motor: this.motor,
      position: Math.max(this.stops?.low ?? -Infinity, Math.min(this.stops?.high ?? Infinity, wanted)) });
  }

  show(motor, switches) {
    this.position = motor.true_position;
    this.stops = motor.stops;
    this.setView(motor);
    const shown = this.turn ? whole(motor.true_position, this.turn) : motor.true_position;
    this.range.min = this.turn ? 0 : Math.max(this.low, motor.stops?.low ?? -Infinity);
    this.range.max = this.turn ? this.turn - 1 : Math.min(this.high, motor.stops?.high ?? Infinity);
    if (document.activeElement !== this.range || !this.range.matches(":active"))
      this.range.value = shown;
    this.jammed.checked = motor.jammed;
    this.lead.checked = motor.missing_lead;
    const why = motor.hold ? `, ${motor.hold}` : "";
    const angle = this.turn ? ` (${motor.angle}/${this.turn})` : "";
    write(this.text, `${motor.true_position}${angle} ${word("lost-steps", motor.lost)}${why}`);
    while (this.lamps.children.length < switches.length)
      this.lamps.append(lamp(""));
    switches.forEach((one, at) => {
      write(this.lamps.children[at], this.nameOf(one.input));
      light(this.lamps.children[at], one.actuated, this.nameOf(one.input));
    });
    const parts = this.turn ? this.drawTurntable(motor, switches) : this.drawSlide(motor, switches);
    this.picture.replaceChildren(...parts);
    this.picture.setAttribute("aria-label", `${word("axis", this.motor)}: ${this.text.textContent}`);
  }

  // What part of the axis is shown: from stop to stop; without a stop as much as has been needed, with room to drag it
  // beyond.
  setView({ true_position: position, stops }) {
    while (position < this.low)
      this.low *= 2;
    while (position > this.high)
      this.high *= 2;
    this.low = stops?.low ?? Math.min(this.low, (stops?.high ?? 0) - 1000);
    this.high = stops?.high ?? Math.max(this.high, (stops?.low ?? 0) + 1000);
  }

  drawSlide(motor, switches) {
    const x = (value) => EDGE + (Math.min(this.high, Math.max(this.low, value)) - this.low) / Math.max(1, this.high - this.low)
      * (WIDTH - 2 * EDGE);
    const parts = [makeSvg("line", { x1: EDGE, y1: TRACK, x2: WIDTH - EDGE, y2: TRACK, class: "track" })];
    switches.forEach((one, at) => {
      const from = x(one.from ?? this.low), to = x(one.to ?? this.high), y = TRACK + 8 + (at % 3) * 4;
      parts.push(
        makeSvg("rect", { x: from, y, width: Math.max(2, to - from), height: 3, class: one.actuated ? "range lit" : "range" }),
        makeSvg("text", { x: Math.min(from, WIDTH - 60), y: 66 }, this.nameOf(one.input)));
    });
    for (const [stop, side] of [[motor.stops?.low, -1], [motor.stops?.high, 1]])
      if (stop !== null && stop !== undefined) {
        const at = x(stop);
        parts.push(makeSvg("rect", { x: side < 0 ? at - 10 : at, y: TRACK - 16, width: 10, height: 24, class: "stop-block" }),
          makeSvg("text", { x: at, y: 12, "text-anchor": side < 0 ? "start" : "end" }, String(stop)));
      }
    const held = motor.jammed || motor.hold ? " held" : "";
    const carriage = { x: x(motor.true_position) - 9, y: TRACK - 14, width: 18, height: 20, rx: 3, class: "carriage" + held };
    return [...parts, makeSvg("rect", carriage)];
  }

  drawTurntable(motor, switches) {
    const at = (value, radius) => {
      const angle = value / this.turn * 2 * Math.PI;
      return [CENTRE + radius * Math.sin(angle), CENTRE - radius * Math.cos(angle)];
    };
    const parts = [makeSvg("circle", { cx: CENTRE, cy: CENTRE, r: RADIUS, class: "track" })];
    switches.forEach((one, index) => {
      const from = one.from ?? 0, to = one.to ?? this.turn - 1;
      const width = Math.min(this.turn - 1, Math.max(this.turn / 180, whole(to - from, this.turn)));
      const radius = RADIUS + 7 + (index % 3) * 5, [x1, y1] = at(from, radius), [x2, y2] = at(from + width, radius);
      const [x, y] = at(from + width / 2, RADIUS - 14);
      parts.push(makeSvg("path", { d: `M${x1} ${y1}A${radius} ${radius} 0 ${width > this.turn / 2 ? 1 : 0} 1 ${x2} ${y2}`,
        class: one.actuated ? "arc lit" : "arc" }), makeSvg("text", { x, y, "text-anchor": "middle" }, this.nameOf(one.input)));
    });
    const held = motor.jammed || motor.hold ? " held" : "", [x, y] = at(motor.true_position, RADIUS);
    parts.push(makeSvg("line", { x1: CENTRE, y1: CENTRE, x2: x, y2: y, class: "needle" + held }),
      makeSvg("circle", { cx: x, cy: y, r: 7, class: "carriage" + held }));
    return parts;
  }
}
