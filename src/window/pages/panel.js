// SPDX-License-Identifier: MIT
// The panel: the inside of virtual units, over the control socket of their emulator (docs/CONTROL.md).
import { ask, call, on } from "./link.js";
import { word } from "./words.js";
import { UnitView } from "./unit.js";
import { describeAnswer, describeRequest, fromHex, spaced, text } from "./decode.js";
import { hasFaults, readKinds, showFaultForm, showFaults } from "./faults.js";
import { make, write } from "./make.js";

const $ = (id) => document.getElementById(id);
const LINES_MAX = 500;
const STEPS = ["1ms", "10ms", "100ms", "1s"];
const STOP_MS = 2000; // until a unit that has not answered counts as not stopped
const LOOK_MS = 1000; // at plants and faults: another page or client may have changed them
const views = new Map();
let emulator = { control: "", units: [], connected: false };
let known = ""; // what the views are of
const events = [];
let found = [];
let visible = false;
let trace = null;
let traces = 0;
let isRecordChanging = false;

export function report(answer) {
  $("panel-text").textContent = answer.error ?? "";
  $("panel-text").classList.toggle("wrong", Boolean(answer.error));
  return answer;
}

export const act = async (method, params) => report(await call(method, params));

// ---- Which emulator ----

function showEmulators() {
  const paths = [...new Set([...found.map((one) => one.control), emulator.control].filter(Boolean))];
  $("emulators").replaceChildren(...paths.map((path) => new Option(path, path, false, path === emulator.control)));
  $("emulator-text").textContent = paths.length === 0 ? word("no-emulator")
    : emulator.control && !emulator.connected && emulator.trouble ? `${word("ended")} ${emulator.trouble}` : "";
}

// The page shows what the units have: a bus, faults that can act, axes that a plant can follow.
function showParts() {
  const has = (part) => emulator.device?.[part] !== false;
  $("dialogue-part").hidden = !has("bus");
  for (const option of $("record-kind").options)
    option.hidden = option.disabled = !has("bus") && ["pcapng", "log"].includes(option.value);
  $("faults-part").hidden = !hasFaults();
  $("plant-part").hidden = !has("plant");
  $("made").hidden = $("faults-part").hidden && $("plant-part").hidden;
}

const identity = ({ control, bus, units, device }) => [control, bus, units.join(), device?.name].join("\n");

function showEmulator(now) {
  const changed = now.connected && identity(now) !== known, isAgain = now.connected && !emulator.connected;
  emulator = now;
  showEmulators();
  $("inside").hidden = !now.connected;
  if (changed) { // what is typed stays while an emulator is away
    known = identity(now);
    views.clear();
    $("units").replaceChildren();
    for (const name of now.units) {
      const view = new UnitView(name, now.device, act);
      views.set(name, view);
      $("units").append(view.element);
    }
  } else if (isAgain) { // with other files, perhaps
    for (const view of views.values())
      view.panel?.begin?.();
  }
  if (!now.connected) {
    trace = null; // it has ended, too
    $("record").textContent = word("record");
    return;
  }
  readKinds().then(() => {
    showFaultForm(act, () => emulator);
    showParts();
  });
  showFaults(act);
}

$("emulator").onsubmit = (event) => {
  event.preventDefault();
  if ($("emulators").value)
    ask("attach", { control: $("emulators").value, bus: Number($("bus").value) });
};

export async function setVisible(now) {
  visible = now;
  await ask("watch", { on: now });
  if (now && !emulator.control)
    found = (await ask("ports")).emulators ?? found;
  showEmulators();
}

// ---- Time ----

function showTime(state) {
  $("time").textContent = (state.t_us / 1e6).toFixed(6) + " s";
  if (document.activeElement !== $("clock")) {
    if (![...$("clock").options].some((option) => option.value === state.clock))
      $("clock").append(new Option(state.clock));
    $("clock").value = state.clock;
  }
  for (const button of $("steps").children)
    button.disabled = state.clock !== "stepped";
}

$("clock").onchange = () => act("clock", { clock: $("clock").value });

function stepButton(text, params) {
  const button = document.createElement("button");
  button.textContent = text;
  button.disabled = $("clock").value !== "stepped";
  button.onclick = () => act("advance", params);
  return button;
}

// ---- Snapshots, traces ----

const name = () => $("snapshot-name").value || "s1";
const show = (text) => { $("panel-text").textContent = text; };

$("snapshot").onclick = async () => {
  if (!(await act("snapshot", { name: name() })).error)
    show(`${word("snapshot-name")} ${name()}: ${word("done")}`);
};
$("restore").onclick = async () => {
  if (!(await act("restore", { name: name() })).error)
    show(`${word("restore")}: ${word("done")}`);
};

function offer(file) {
  const link = document.createElement("a");
  link.href = "download/" + file;
  link.download = link.textContent = file;
  $("downloads").append(link);
}

$("record").onclick = async () => {
  if (isRecordChanging)
    return; // the second click of two
  isRecordChanging = true;
  await changeRecord();
  isRecordChanging = false;
};

async function changeRecord() {
  if (trace) {
    const { number, file } = trace;
    trace = null;
    if (!(await act("trace.stop", { trace: number })).error)
      offer(file);
  } else {
    const file = `trace-${Date.now().toString(36)}-${++traces}.${$("record-kind").value}`;
    const answer = await act("trace.start", { file });
    if (!answer.error)
      trace = { number: answer.trace, file };
  }
  showWords();
}

$("recording").onclick = async () => {
  const file = `bus-${Date.now().toString(36)}-${++traces}.record`;
  if (!(await act("snapshot", { file })).error)
    offer(file);
};

// ---- Plant ----

$("plant-open").onclick = () => $("plant-file").click();
$("plant-none").onclick = () => act("plant.set", { plant: null });
$("plant-file").onchange = async () => {
  const file = $("plant-file").files[0];
  if (file)
    await act("plant.set", { plant: await file.text() });
  $("plant-file").value = "";
};

// ---- Dialogue ----

// A message of the RKM04 in words; of another device as its text, or as its bytes.
function sayMessage(event) {
  const bytes = fromHex(event.message);
  const isText = bytes.every((byte) => (byte >= 0x20 && byte < 0x7f) || byte === 0x0a || byte === 0x0d);
  if (emulator.device && emulator.device.name !== "rkm04")
    return isText ? text(bytes) : spaced(event.message);
  return bytes.length === 0 ? "" : event.answer ? describeAnswer(bytes) : describeRequest(bytes);
}

function describe(event) {
  if (event.kind !== "message")
    return `[${event.unit ?? ""}] ${event.text ?? event.value}`;
  const from = (event.from ?? []).join("+"), words = sayMessage(event);
  const wrong = event.dropped ?? event.refused;
  return `${from} ${word(event.answer ? "answer" : "ask")} ${event.snode}→${event.dnode}: ${words}${wrong ? ` (${wrong})` : ""}`;
}

const say = (bus) => `${(bus.t_us / 1e6).toFixed(6)} ${describe(bus)}`;

function addEvent({ bus }) {
  const element = make("p", { class: bus.dropped || bus.refused || bus.kind !== "message" ? "wrong" : "" }, say(bus));
  const log = $("dialogue"), atEnd = log.scrollTop + log.clientHeight > log.scrollHeight - 20;
  events.push({ bus, element });
  log.append(element);
  if (events.length > LINES_MAX)
    events.shift().element.remove();
  if (atEnd)
    log.scrollTop = log.scrollHeight;
  if (bus.kind === "injected")
    showFaults(act);
}

// ---- All ----

// Stop all motors of units of other devices than the RKM04, which has K for it. Returns how many did, and why others did not.
export async function stopUnits() {
  const late = () => new Promise((done) => setTimeout(() => done({ error: word("stop-silent") }), STOP_MS));
  const stopped = [...views].filter(([, view]) => emulator.connected && view.panel)
    .map(async ([name, view]) => ({ name, ...await Promise.race([view.panel.stop(), late()]) }));
  const answers = await Promise.all(stopped), failed = answers.filter((answer) => answer.error !== undefined);
  const why = failed[0]?.error || word("stop-silent");
  return { done: answers.length - failed.length, failed: failed.map(({ name }) => name).join(" "), why };
}

export function showWords() {
  $("record").textContent = word(trace ? "record-stop" : "record");
  $("steps").replaceChildren(...STEPS.map((step) => stepButton("+" + step, { ticks: step })),
    stepButton(word("idle"), { until: { idle: true }, limit: "60s" }));
  showFaultForm(act, () => emulator);
  for (const view of views.values())
    view.build();
  for (const { bus, element } of events)
    write(element, say(bus));
  showEmulators();
}

export async function begin(hello) {
  trace = null;
  showEmulator(hello.emulator);
  if (visible || hello.emulator.control)
    await ask("watch", { on: visible });
  showWords();
}

$("clear-faults").onclick = async () => {
  await act("fault.clear", {});
  showFaults(act);
};
setInterval(() => {
  if (!visible || document.hidden || !emulator.connected)
    return;
  for (const view of views.values())
    view.lookAtPlant();
  if (hasFaults())
    showFaults(act);
}, LOOK_MS);
on("emulator", showEmulator);
on("found", (emulators) => { found = emulators; showEmulators(); });
on("state", ({ unit, state }) => {
  views.get(unit)?.show(state);
  showTime(state);
});
on("bus", addEvent);
