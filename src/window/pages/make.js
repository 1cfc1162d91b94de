// SPDX-License-Identifier: MIT
// Elements of the page.
import { word } from "./words.js";

export function make(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes))
    key.startsWith("on") ? element.addEventListener(key.slice(2), value) : element.setAttribute(key, value);
  element.append(...children);
  return element;
}

export function makeSvg(name, attributes = {}, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes))
    element.setAttribute(key, value);
  if (text !== undefined)
    element.textContent = text;
  return element;
}

export const two = (number) => String(number).padStart(2, "0");

export const group = (title, children) => make("fieldset", {}, make("legend", {}, title), ...children);

export const lamp = (text) => make("span", { class: "lamp", role: "img" }, text);

export function light(element, on, name) {
  element.classList.toggle("lit", on);
  element.setAttribute("aria-label", `${name} ${on ? 1 : 0}`);
}

// A table that may be wider than the page, and is scrolled with the keyboard then.
export function makeScrolled(table) {
  return make("div", { class: "motors", tabindex: "0", role: "group", "aria-label": word("state") }, table);
}

// Write a text only where it differs: an unchanged one costs nothing.
export function write(element, text) {
  if (element.textContent !== text)
    element.textContent = text;
}
