// SPDX-License-Identifier: MIT
// Curves over time on a canvas: four motors, of each the values of the last minute.
const SPAN_MS = 60000;

export class Graph {
  constructor(canvas, bands = 1) {
    this.canvas = canvas;
    this.bands = bands;
    this.points = Array.from({ length: bands }, () => [[], [], [], []]);
    this.wanted = false;
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  // A value of the motor 0 to 3 at a time in ms.
  add(band, motor, time, value) {
    const list = this.points[band][motor];
    list.push([time, value]);
    while (list.length > 2 && list[1][0] < time - SPAN_MS)
      list.shift();
    this.draw();
  }

  draw() {
    if (this.wanted || this.canvas.offsetParent === null)
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
    const context = canvas.getContext("2d");
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, width, height);
    for (let band = 0; band < this.bands; band++)
      this.paintBand(context, this.points[band], band * height / this.bands, height / this.bands, width);
  }

  paintBand(context, lists, top, height, width) {
    const style = getComputedStyle(this.canvas);
    const values = lists.flat().map((point) => point[1]);
    if (values.length === 0)
      return;
    const end = Math.max(...lists.filter((list) => list.length > 0).map((list) => list.at(-1)[0]));
    let low = 0, high = 1;
    for (const value of values) {
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    const x = (time) => width - (end - time) / SPAN_MS * width;
    const y = (value) => top + height - 6 - (value - low) / (high - low) * (height - 24);
    context.fillStyle = context.strokeStyle = style.getPropertyValue("--soft");
    context.font = "12px system-ui, sans-serif";
    context.fillText(`${low} … ${high}`, 4, top + 13);
    lists.forEach((list, motor) => {
      context.strokeStyle = style.getPropertyValue(`--m${motor + 1}`);
      context.setLineDash([[], [6, 3], [2, 2], [8, 3, 2, 3]][motor]);
      context.lineWidth = 1.5;
      context.beginPath();
      list.forEach(([time, value], at) => (at === 0 ? context.moveTo(x(time), y(value)) : context.lineTo(x(time), y(value))));
      context.stroke();
    });
  }
}

// The profile [[step, speed], …] with a mark at the present step, into an SVG of 640 by 220.
export function drawProfile(svg, table, step) {
  const make = (name, attributes, text) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes))
      element.setAttribute(key, value);
    if (text !== undefined)
      element.textContent = text;
    return element;
  };
  const parts = [];
  if (table.length > 0) {
    const last = Math.max(1, table.at(-1)[0]), peak = Math.max(1, ...table.map((point) => point[1]));
    const x = (value) => 50 + Math.min(value, last) / last * 570, y = (value) => 190 - value / peak * 165;
    parts.push(make("line", { x1: 50, y1: 190, x2: 620, y2: 190, class: "grid" }), make("line", { x1: 50, y1: 190, x2: 50, y2: 20, class: "grid" }));
    // Between two points the square of the speed grows evenly with the steps.
    const path = [];
    table.forEach(([at, speed], index) => {
      const [before, was] = table[Math.max(0, index - 1)];
      for (let part = 1; part <= 16; part++) {
        const square = was * was + (speed * speed - was * was) * part / 16;
        path.push(`${path.length ? "L" : "M"}${x(before + (at - before) * part / 16).toFixed(1)} ${y(Math.sqrt(square)).toFixed(1)}`);
      }
    });
    parts.push(make("path", { d: path.join(""), class: "curve" }), make("text", { x: 50, y: 208 }, "1"),
      make("text", { x: 620, y: 208, "text-anchor": "end" }, String(last)), make("text", { x: 46, y: 29, "text-anchor": "end" }, String(peak)));
    if (step !== null)
      parts.push(make("line", { x1: x(step), y1: 190, x2: x(step), y2: 20, class: "mark" }), make("text", { x: x(step), y: 16, "text-anchor": "middle" }, String(step)));
  }
  svg.replaceChildren(...parts);
}
