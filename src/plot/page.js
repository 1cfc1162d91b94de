// SPDX-License-Identifier: MIT
// The page of a plot: the wheel zooms in time, dragging moves, a double click shows all; the pointer shows values.
"use strict";
(() => {
  const picture = document.querySelector("svg.plot");
  const corners = JSON.parse(document.getElementById("corners").textContent);
  const readout = document.getElementById("readout");
  const all = [Number(picture.dataset.from), Number(picture.dataset.to)];
  const left = Number(picture.dataset.left);
  const panels = [...picture.querySelectorAll("svg.panel")];
  const size = panels[0].viewBox.baseVal.width;
  const labels = [...picture.querySelectorAll(".label")];
  const axis = picture.querySelector(".axis");
  const axisY = Number(axis.querySelector("text").getAttribute("y"));
  const grids = [...picture.querySelectorAll(".times")];
  let [from, to] = all;

  // 1, 2 or 5 times a power of ten, not less than `least`.
  function roundUp(least) {
    const power = 10 ** Math.floor(Math.log10(least));
    return power * [1, 2, 5, 10].find((factor) => factor * power >= least * 0.9999999);
  }

  // A time in px of the whole picture's panels.
  const placeAll = (us) => ((us - all[0]) / (all[1] - all[0])) * size;
  const placeNow = (us) => ((us - from) / (to - from)) * size;

  function marks() {
    const step = roundUp((to - from) / Math.max(1, Math.floor(size / 90)));
    const list = [];
    for (let us = Math.ceil(from / step - 1e-9) * step; us <= to + step * 1e-9; us += step) list.push(us);
    return [list, step];
  }

  function drawAxis() {
    const [list, step] = marks();
    const milliseconds = step < 1e4;
    const digits = Math.max(0, -Math.floor(Math.log10(step * (milliseconds ? 1e-3 : 1e-6)) + 1e-9));
    axis.replaceChildren(...list.map((us) => {
      const text = document.createElementNS("http://www.w3.org/2000/svg", "text");
      text.setAttribute("class", "soft middle");
      text.setAttribute("x", left + placeNow(us));
      text.setAttribute("y", axisY);
      text.textContent = (us * (milliseconds ? 1e-3 : 1e-6)).toFixed(digits);
      return text;
    }));
    picture.querySelector(".unit").textContent = milliseconds ? "ms" : "s";
    for (const grid of grids) {
      const height = grid.parentNode.viewBox.baseVal.height;
      grid.setAttribute("d", list.map((us) => `M${placeAll(us)} 0V${height}`).join(""));
    }
  }

  function draw() {
    for (const panel of panels)
      panel.setAttribute("viewBox", `${placeAll(from)} 0 ${(size * (to - from)) / (all[1] - all[0])} ${panel.viewBox.baseVal.height}`);
    for (const label of labels) {
      const x = placeNow(Number(label.dataset.us));
      label.setAttribute("x", left + x);
      label.style.display = x < 0 || x > size ? "none" : "";
    }
    drawAxis();
  }

  function show(newFrom, newTo) {
    const span = Math.min(Math.max(newTo - newFrom, 1e3), all[1] - all[0]);
    from = Math.min(Math.max(newFrom, all[0]), all[1] - span);
    to = from + span;
    draw();
  }

  // Speed and position of a motor at a time: between two corners the acceleration is constant.
  function valueAt(list, us) {
    let low = 0, high = list.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (list[middle][0] < us) low = middle + 1; else high = middle;
    }
    if (low === 0 || low === list.length) return [0, list[Math.max(0, low - 1)][2]];
    const a = list[low - 1], b = list[low];
    const part = b[0] > a[0] ? (us - a[0]) / (b[0] - a[0]) : 1;
    const speed = a[1] + (b[1] - a[1]) * part;
    return [speed, a[2] + ((a[1] + speed) / 2) * (us - a[0]) * 1e-6];
  }

  function timeUnder(event) {
    const box = picture.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * picture.viewBox.baseVal.width - left;
    return from + (x / size) * (to - from);
  }

  picture.addEventListener("wheel", (event) => {
    event.preventDefault();
    const us = timeUnder(event), factor = event.deltaY < 0 ? 0.8 : 1.25;
    show(us - (us - from) * factor, us + (to - us) * factor);
  }, {passive: false});

  let grabbed = null;
  picture.addEventListener("pointerdown", (event) => { grabbed = timeUnder(event); picture.setPointerCapture(event.pointerId); });
  picture.addEventListener("pointerup", () => { grabbed = null; });
  picture.addEventListener("dblclick", () => show(...all));
  picture.addEventListener("pointermove", (event) => {
    const us = timeUnder(event);
    if (grabbed !== null) show(from + grabbed - us, to + grabbed - us);
    if (us < from || us > to) return;
    readout.textContent = `${(us * 1e-6).toFixed(6)} s  ` + Object.entries(corners).map(([motor, list]) => {
      const [speed, position] = valueAt(list, us);
      return `motor ${motor}: ${speed.toFixed(1)} steps/s, position ${position.toFixed(1)}`;
    }).join("   ");
  });

  // The same by keys.
  document.addEventListener("keydown", (event) => {
    const span = to - from, middle = (from + to) / 2;
    const ways = {
      "+": [middle - span * 0.4, middle + span * 0.4], "-": [middle - span * 0.625, middle + span * 0.625],
      ArrowLeft: [from - span / 10, to - span / 10], ArrowRight: [from + span / 10, to + span / 10], "0": all, Home: all,
    };
    if (ways[event.key]) { show(...ways[event.key]); event.preventDefault(); }
  });
  draw();
})();
