// SPDX-License-Identifier: MIT
// Keys that act as long as they are held: with the mouse, a finger, Space or Enter. They are let go when the page loses the
// focus, is hidden or loses its connection; and, when the page goes, by rkmctl window, which has been given the call for it.
import { ask, on } from "./link.js";
import { make } from "./make.js";

const held = new Set();

export function releaseAll() {
  for (const one of [...held])
    one.release();
}

addEventListener("blur", releaseAll);
addEventListener("pagehide", releaseAll);
document.addEventListener("visibilitychange", () => document.hidden && releaseAll());
on("close", releaseAll);

// What rkmctl window calls when this page goes; without a method nothing.
export const leave = (method, params) => ask("leave", method ? { method, params } : {});

// A button: set(true) when it is pressed, set(false) when it is let go.
export function makeHeld(text, set, attributes = {}) {
  const button = make("button", { class: "held", ...attributes }, text);
  const one = {
    release() {
      if (held.delete(one))
        set(false);
    },
  };
  const hold = () => {
    if (!held.has(one)) {
      held.add(one);
      set(true);
    }
  };
  const ifKey = (act) => (event) => {
    if (event.key === " " || event.key === "Enter") {
      event.preventDefault();
      act();
    }
  };
  button.addEventListener("pointerdown", (event) => event.button === 0 && hold());
  for (const name of ["pointerup", "pointerleave", "pointercancel", "blur"])
    button.addEventListener(name, one.release);
  button.addEventListener("contextmenu", (event) => event.preventDefault());
  button.addEventListener("keydown", ifKey(hold));
  button.addEventListener("keyup", ifKey(one.release));
  return button;
}
