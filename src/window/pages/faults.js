// SPDX-License-Identifier: MIT
// Injected faults: a form made out of their descriptions (docs/CONTROL.md), and the list of those there are.
import { call } from "./link.js";
import { word } from "./words.js";

const $ = (id) => document.getElementById(id);
const directions = ["", "to_units", "to_master", "both"];
const operations = ["", "write", "erase", "program", "read"];
const common = ["count", "skip", "probability", "after", "for"];

// Kind: its parameters; those with ! are required.
export const kinds = {
  drop: ["direction", "unit"], flip: ["mask", "direction", "unit"], duplicate: ["direction", "unit"],
  insert: ["byte", "direction", "unit"], delay: ["delay!", "unit"], no_answer: ["unit"], wrong_fcs: ["unit"],
  cut: ["bytes!", "unit"], echo: [], break: ["duration", "every"], unplugged: ["duration", "every"],
  cable: ["duration", "every", "unit"], flash: ["operation", "torn", "unit"], power: ["operation", "duration", "unit"],
  input: ["input!", "level!", "duration", "every", "unit"],
};
const times = new Set(["delay", "duration", "every", "after", "for"]);

function makeField(parameter, kind, units) {
  const name = parameter.replace("!", ""), choices = name === "direction" ? directions : name === "unit" ? ["", ...units]
    : name === "operation" && kind === "flash" ? operations : name === "torn" ? ["", "true", "false"]
    : name === "level" ? ["0", "1"] : null;
  const label = document.createElement("label");
  const field = document.createElement(choices ? "select" : "input");
  field.name = name;
  field.required = parameter.endsWith("!");
  if (choices)
    field.append(...choices.map((choice) => new Option(choice)));
  else
    field.placeholder = times.has(name) ? "10ms" : name === "probability" ? "0.1" : "";
  if (!choices)
    field.size = 6;
  label.append(name + " ", field);
  return label;
}

function readFields(form) {
  const params = {};
  for (const field of form.elements) {
    if (!field.name || field.value === "")
      continue;
    const text = field.value.trim();
    params[field.name] = field.name !== "unit" && /^-?\d+(\.\d+)?$/.test(text) ? Number(text)
      : text === "true" || text === "false" ? text === "true" : text;
  }
  return params;
}

export function showFaultForm(act, units) {
  const form = $("fault");
  const chosen = form.elements.kind?.value ?? "drop";
  const kind = document.createElement("select"), label = document.createElement("label"), button = document.createElement("button");
  kind.name = "kind";
  kind.append(...Object.keys(kinds).map((one) => new Option(one, one, false, one === chosen)));
  kind.onchange = () => {
    showFaultForm(act, units);
    form.elements.kind.focus();
  };
  label.append(kind);
  kind.setAttribute("aria-label", word("faults"));
  button.textContent = word("inject");
  form.replaceChildren(label, ...[...kinds[chosen], ...common].map((one) => makeField(one, chosen, units())), button);
  form.onsubmit = async (event) => {
    event.preventDefault();
    await act("fault.inject", readFields(form));
    showFaults(act);
  };
}

export async function showFaults(act) {
  const answer = await call("fault.list");
  const items = (answer.faults ?? []).map((fault) => {
    const item = document.createElement("li"), button = document.createElement("button"), text = document.createElement("span");
    const shown = Object.entries(fault).filter(([name, value]) => value !== null && !["id", "kind", "state"].includes(name));
    text.textContent = `${fault.id} ${fault.kind}: ${fault.state}, ${shown.map(([name, value]) => `${name}=${value}`).join(" ")}`;
    button.textContent = `${word("clearone")} ${fault.id}`;
    button.onclick = async () => {
      await act("fault.clear", { id: fault.id });
      showFaults(act);
    };
    item.append(button, text);
    return item;
  });
  $("faults").replaceChildren(...items);
}
