// SPDX-License-Identifier: MIT
// The page: views, keys, language and colours, the connection.
import { call, connect, on, ask } from "./link.js";
import { setLanguage, word } from "./words.js";
import * as service from "./service.js";
import * as panel from "./panel.js";
import { check } from "./editor.js";

const $ = (id) => document.getElementById(id);
const tabs = ["service", "panel"];

const remembered = (name) => { try { return localStorage.getItem(name); } catch { return null; } };
function remember(name, value) {
  try {
    localStorage.setItem(name, value);
  } catch { /* not allowed: the page works without */ }
}

function showTab(name) {
  for (const tab of tabs) {
    const chosen = tab === name;
    $(tab).hidden = !chosen;
    $("tab-" + tab).setAttribute("aria-selected", String(chosen));
    $("tab-" + tab).tabIndex = chosen ? 0 : -1;
  }
  panel.setVisible(name === "panel");
}

for (const tab of tabs) {
  $("tab-" + tab).onclick = () => showTab(tab);
  $("tab-" + tab).onkeydown = (event) => {
    if (event.key !== "ArrowLeft" && event.key !== "ArrowRight")
      return;
    const other = tabs[1 - tabs.indexOf(tab)];
    showTab(other);
    $("tab-" + other).focus();
  };
}

const system = matchMedia("(prefers-color-scheme: dark)");
function showTheme() {
  const dark = $("theme").value === "dark" || ($("theme").value === "auto" && system.matches);
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  dispatchEvent(new Event("theme"));
}
system.onchange = showTheme;
$("theme").value = remembered("theme") ?? "auto";
$("theme").onchange = () => { remember("theme", $("theme").value); showTheme(); };
showTheme();

function showLanguage() {
  setLanguage($("language").value);
  service.showWords();
  panel.showWords();
}
$("language").value = remembered("language") ?? (navigator.language.startsWith("cs") ? "cs" : "en");
$("language").onchange = async () => {
  remember("language", $("language").value);
  showLanguage();
  check();
  service.showPort((await ask("hello")).port ?? { port: null });
};
showLanguage();

document.addEventListener("keydown", (event) => {
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const name = (event.ctrlKey ? "Control+" : "") + (event.altKey ? "Alt+" : "") + key;
  if (!service.keys[name] || event.shiftKey || event.metaKey || ($("service").hidden && name !== "F8"))
    return; // but for Stop all they are keys of the service view
  event.preventDefault();
  if (!event.repeat) // a key that is held sends once
    service.keys[name]();
});

// A file that is dropped beside its place does not take the page away.
for (const name of ["dragover", "drop"])
  addEventListener(name, (event) => event.preventDefault());

let isOpened = false;
on("open", async () => {
  const hello = await ask("hello");
  if (!hello.port)
    return;
  service.begin(hello);
  panel.begin(hello);
  if (!isOpened && !hello.port.port && hello.emulator.control && (await call("device")).bus === false)
    showTab("panel"); // there is nothing to be opened in the other view
  isOpened = true;
});
on("close", () => service.say(word("lost"), true));
history.replaceState(null, "", location.pathname); // the token does not stay in the address
connect();
