// SPDX-License-Identifier: MIT
// Injected faults: a form made out of what `fault.kinds` of the control socket tells, and the list of those there are.
import { call } from "./link.js";
import { word } from "./words.js";
import { make } from "./make.js";

const $ = (id) => document.getElementById(id);
let told = { kinds: [], common: [] };

// What inputs there are: names, or numbers.
function inputsOf({ input_names: names, inputs }) {
  return names ?? Array.from({ length: inputs ?? 8 }, (_, at) => String(at + 1));
}

function makeField({ name, type, required, choices }, emulator) {
  const list = choices ?? { unit: emulator.units, flag: ["1", "0"], input: inputsOf(emulator.device ?? {}) }[type] ?? null;
  const field = document.createElement(list ? "select" : "input");
  field.name = name;
  field.required = required;
  field.dataset.type = type;
  if (list)
    field.append(...[...(required ? [] : [""]), ...list].map((choice) => new Option(choice)));
  else {
    field.placeholder = type === "time" ? "10ms" : name === "probability" ? "0.1" : "";
    field.size = 6;
  }
  return make("label", {}, name + " ", field);
}

function readFields(form) {
  const params = {};
  for (const field of form.elements) {
    const text = field.value.trim(), { type } = field.dataset;
    if (!field.name || text === "")
      continue;
    params[field.name] = ["number", "time", "flag", "input"].includes(type) && /^-?\d+(\.\d+)?$/.test(text) ? Number(text) : text;
  }
  return params;
}

// Asks what faults there are; then the form can be shown.
export async function readKinds() {
  const answer = await call("fault.kinds");
  if (answer.kinds)
    told = answer;
}

export const hasFaults = () => told.kinds.length > 0;

// `emulator` gives what is attached at the time.
export function showFaultForm(act, emulator) {
  const form = $("fault"), names = told.kinds.map((one) => one.kind);
  const chosen = form.elements.kind?.value || names[0], kind = told.kinds.find((one) => one.kind === chosen);
  const choice = make("select", { name: "kind", "aria-label": word("faults") });
  choice.append(...names.map((one) => new Option(one, one, false, one === chosen)));
  choice.onchange = () => {
    showFaultForm(act, emulator);
    form.elements.kind.focus();
  };
  const fields = [...(kind?.parameters ?? []), ...told.common].map((one) => makeField(one, emulator()));
  form.replaceChildren(make("label", {}, choice), ...fields, make("button", {}, word("inject")));
  form.onsubmit = async (event) => {
    event.preventDefault();
    await act("fault.inject", readFields(form));
    showFaults(act);
  };
}

export async function showFaults(act) {
  const answer = await call("fault.list");
  const items = (answer.faults ?? []).map((fault) => {
    const shown = Object.entries(fault).filter(([name, value]) => value !== null && !["id", "kind", "state"].includes(name));
    const text = `${fault.id} ${fault.kind}: ${fault.state}, ${shown.map(([name, value]) => `${name}=${value}`).join(" ")}`;
    const clear = async () => {
      await act("fault.clear", { id: fault.id });
      showFaults(act);
    };
    return make("li", {}, make("button", { onclick: clear }, `${word("clearone")} ${fault.id}`), make("span", {}, text));
  });
  if (items.map((item) => item.textContent).join() !== [...$("faults").children].map((item) => item.textContent).join())
    $("faults").replaceChildren(...items);
}
