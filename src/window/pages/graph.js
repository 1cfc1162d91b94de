// SPDX-License-Identifier: MIT
// Curves over time on a canvas: of each motor the values of the last minute.
import { makeSvg } from "./make.js";

const SPAN_MS = 60000;
const PART_MS = 150; // what comes within one part is drawn as its first, lowest, highest and last value
const COLOURS = 4;
const DASHES = [[], [6, 3], [2, 2], [8, 3, 2, 3]];

const QUIET_MS = 300; // of real time: a value that has not come for so long has not changed
const ROUND_MS = 50; // about so long before a new value the old one has been read

// Those there are: they are drawn in the colours of the page.
const graphs = new Set();
addEventListener("theme", () => {
  for (const graph of graphs)
    graph.canvas.isConnected ? graph.draw() : graphs.delete(graph);
});

const round = (value) => Math.round(value * 1000) / 1000;

export class Graph {
  constructor(canvas, bands = 1, motors = 4) {
    this.canvas = canvas;
    this.bands = bands;
    this.parts = Array.from({ length: bands }, () => Array.from({ length: motors }, () => []));
    this.hidden = this.parts.map(() => new Set()); // motors that are not drawn
    this.titles = []; // of the bands
    this.wanted = false;
    this.inSight = false;
    graphs.add(this);
    new ResizeObserver(() => this.draw()).observe(canvas);
    new IntersectionObserver((entries) => {
      this.inSight = entries.at(-1).isIntersecting;
      this.draw();
    }).observe(canvas);
  }

  // The values of another one.
  take(other) { this.parts = other.parts; }

  clear() { this.parts.forEach((lists) => lists.forEach((list) => { list.length = 0; })); }

  // Motors, from 0, that are not drawn.
  hide(band, motors) {
    this.hidden[band] = motors;
    this.draw();
  }

  // A value of a motor, from 0, at a time in ms.
  add(band, motor, time, value) {
    const list = this.parts[band][motor];
    if (list.length > 0 && time < list.at(-1).time)
      list.length = 0; // a restored snapshot: another past
    const before = list.at(-1), now = performance.now(), quiet = before ? now - before.real : 0;
    if (quiet > QUIET_MS && time > before.time) // a part of its own: the old value up to shortly before the new one
      list.push({ begin: before.time, time: time - (time - before.time) * ROUND_MS / quiet, real: now, first: before.last,
        low: before.last, high: before.last, last: before.last });
    const last = quiet > QUIET_MS ? null : before;
    if (last && time < last.begin + PART_MS) {
      last.low = Math.min(last.low, value);
      last.high = Math.max(last.high, value);
      last.last = value;
      last.time = time;
      last.real = now;
    } else {
      list.push({ begin: time, time, real: now, first: value, low: value, high: value, last: value });
    }
    while (list.length > 2 && list[1].time < time - SPAN_MS)
      list.shift();
    this.draw();
  }

  draw() {
    if (this.wanted || !this.inSight)
      return;
    this.wanted = true;
    requestAnimationFrame(() => { this.wanted = false; this.paint(); });
  }

  paint() {
    const { canvas } = this;
    const scale = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
      canvas.width = Math.round(width * scale);
      canvas.height = Math.round(height * scale);
    }
    const context = canvas.getContext("2d"), style = getComputedStyle(canvas);
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, width, height);
    for (let band = 0; band < this.bands; band++)
      this.paintBand(context, style, band, band * height / this.bands, height / this.bands, width);
  }

  paintBand(context, style, band, top, height, width) {
    const lists = this.parts[band].map((list, motor) => this.hidden[band].has(motor) ? [] : list);
    const filled = lists.filter((list) => list.length > 0);
    if (filled.length === 0)
      return;
    const end = Math.max(...filled.map((list) => list.at(-1).time));
    let low = 0, high = 1;
    for (const list of filled)
      for (const part of list) {
        low = Math.min(low, part.low);
        high = Math.max(high, part.high);
      }
    const x = (time) => width - (end - time) / SPAN_MS * width;
    const y = (value) => top + height - 6 - (value - low) / (high - low) * (height - 24);
    context.fillStyle = style.getPropertyValue("--soft");
    context.font = "12px system-ui, sans-serif";
    context.fillText(`${this.titles[band] ?? ""} ${round(low)} … ${round(high)}`.trim(), 4, top + 13);
    context.lineWidth = 1.5;
    lists.forEach((list, motor) => {
      context.strokeStyle = style.getPropertyValue(`--m${motor % COLOURS + 1}`);
      context.setLineDash(DASHES[(motor + Math.floor(motor / COLOURS)) % COLOURS]);
      context.beginPath();
      for (const part of list) {
        context.lineTo(x(part.begin), y(part.first));
        for (const peak of [part.low, part.high])
          if (peak < Math.min(part.first, part.last) || peak > Math.max(part.first, part.last))
            context.lineTo(x((part.begin + part.time) / 2), y(peak));
        context.lineTo(x(part.time), y(part.last));
      }
      context.stroke();
    });
  }
}

// The profile [[step, speed], …] with a mark at the present step, into an SVG of 640 by 220.
export function drawProfile(svg, table, step) {
  const parts = [];
  if (table.length > 0) {
    const last = Math.max(1, table.at(-1)[0]), peak = Math.max(1, ...table.map((point) => point[1]));
    const x = (value) => 50 + Math.min(value, last) / last * 570, y = (value) => 190 - value / peak * 165;
    parts.push(makeSvg("line", { x1: 50, y1: 190, x2: 620, y2: 190, class: "grid" }),
      makeSvg("line", { x1: 50, y1: 190, x2: 50, y2: 20, class: "grid" }));
    // Between two points the square of the speed grows evenly with the steps.
    const path = [];
    table.forEach(([at, speed], index) => {
      const [before, was] = table[Math.max(0, index - 1)];
      for (let part = 1; part <= 16; part++) {
        const square = was * was + (speed * speed - was * was) * part / 16;
        const place = [x(before + (at - before) * part / 16), y(Math.sqrt(square))].map((value) => value.toFixed(1));
        path.push((path.length ? "L" : "M") + place.join(" "));
      }
    });
    parts.push(makeSvg("path", { d: path.join(""), class: "curve" }),
      makeSvg("text", { x: 50, y: 208 }, "1"),
      makeSvg("text", { x: 620, y: 208, "text-anchor": "end" }, String(last)),
      makeSvg("text", { x: 46, y: 29, "text-anchor": "end" }, String(peak)));
    if (step !== null)
      parts.push(makeSvg("line", { x1: x(step), y1: 190, x2: x(step), y2: 20, class: "mark" }),
        makeSvg("text", { x: x(step), y: 16, "text-anchor": "middle" }, String(step)));
  }
  svg.replaceChildren(...parts);
}
