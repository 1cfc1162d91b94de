// SPDX-License-Identifier: MIT
// The service program: port, request, answers, positions, profile. Works with any unit.
import { ask, on, tell } from "./link.js";
import { word } from "./words.js";
import { check, saveText } from "./editor.js";
import { Graph, drawProfile } from "./graph.js";
import { make } from "./make.js";
import { stopUnits } from "./panel.js";
import { describeAnswer, describeRequest, fromHex, messages, readPositions, readTable, spaced, text, toHex } from "./decode.js";

const $ = (id) => document.getElementById(id);
const ENTRIES_MAX = 2000;
const RAW = 0;
const entries = [];
const graph = new Graph($("positions-graph"));
let open = null;
let polling = 0;
let profile = null; // none has been asked for
let profileText = "";

function addNumbers(select, from, to, chosen) {
  for (let number = from; number <= to; number++)
    select.append(new Option(String(number), String(number), false, number === chosen));
}

addNumbers($("node"), 0, 16, 1);
addNumbers($("motor"), 0, 4, 1);
messages.forEach((name, at) => $("message").append(new Option(`${at + 1} ${name}`, String(at + 1), false, at === 1)));
$("message").append(new Option("Raw", String(RAW)));
$("positions-head").append(...[1, 2, 3, 4].map((motor) => make("th", { scope: "col" }, String(motor))));
$("positions").append(...[1, 2, 3, 4].map(() => make("td", {}, "–")));

export function say(message, wrong = false) {
  $("status").textContent = message;
  $("status").classList.toggle("wrong", wrong);
}

// ---- Answers ----

function show(entry) {
  const wanted = $("search").value.toLowerCase();
  entry.element.hidden = wanted !== "" && !entry.element.textContent.toLowerCase().includes(wanted);
}

// Its words, in the present language.
function fill(entry) {
  const { head, raw } = entry.say();
  entry.element.replaceChildren(head, ...(raw ? [make("span", { class: "raw" }, "\n" + raw)] : []));
  show(entry);
}

// `say` gives {head, raw}.
function addEntry(say, wrong) {
  const entry = { element: make("p", { class: wrong ? "wrong" : "" }), say };
  entries.push(entry);
  fill(entry);
  const log = $("answers"), atEnd = log.scrollTop + log.clientHeight > log.scrollHeight - 20;
  log.append(entry.element);
  if (entries.length > ENTRIES_MAX)
    entries.shift().element.remove();
  if (atEnd)
    log.scrollTop = log.scrollHeight;
}

function sayExchange(one, trouble) {
  const time = new Date(one.t_ms).toISOString().slice(11, 23);
  const said = one.outcome === "answered" ? describeAnswer(fromHex(one.answer)) : word(one.outcome);
  const bytes = `> ${spaced(one.request)}${one.answer ? `\n< ${spaced(one.answer)}` : ""}`;
  return {
    head: `${time} [${one.node}] ${describeRequest(fromHex(one.request))}: ${said}${trouble ? "\n" + trouble.trim() : ""}`,
    raw: `${bytes}\n${word("rtt")} ${(one.round_trip_us / 1000).toFixed(1)} ms`,
  };
}

function addExchange(one, trouble) {
  const request = fromHex(one.request), answer = fromHex(one.answer);
  const refused = (request[0] === 2 || request[0] === 3) && answer[2] > 0;
  addEntry(() => sayExchange(one, trouble), one.outcome === "silent" || one.outcome === "lost" || refused);
  if (answer[0] === 4)
    takePositions(answer, one.t_ms);
  if (answer[0] === 6)
    takeProfile(answer);
  if (answer[0] === 7)
    takeProgress(answer);
}

function takeAnswer(object) {
  if (object.request)
    addExchange(object, object.trouble);
  else if (object.messages || object.bus)
    [...(object.messages ?? []), object.unit, object.bus].filter(Boolean).forEach((one) => addExchange(one));
  if (object.pieces !== undefined && object.messages.length > 1)
    addEntry(() => ({ head: word("pieces", object.commands, object.pieces) }), false);
  if (!object.request && object.trouble)
    addEntry(() => ({ head: object.trouble.trim() }), true);
}

$("search").oninput = () => entries.forEach(show);
$("clear").onclick = () => entries.splice(0).forEach((entry) => entry.element.remove());
$("save-answers").onclick = () => saveText(entries.map((entry) => entry.element.textContent + "\n").join(""), "answers.txt");

// ---- Positions and profile ----

function takePositions(bytes, time) {
  const positions = readPositions(bytes), first = bytes[1] === 0x30 ? 0 : bytes[1] - 0x31;
  positions.forEach((position, at) => {
    $("positions").children[first + at].textContent = String(position);
    graph.add(0, first + at, time, position);
  });
}

function takeProfile(bytes) {
  profile = readTable(bytes);
  profileText = profile.length > 0 ? text(bytes.slice(2)).trim() : "";
  $("profile-text").textContent = profileText || word("profile-empty");
  drawProfile($("profile"), profile, null);
  if (profile.length > 0)
    poll("7" + String.fromCharCode(bytes[1]), takeProgress);
}

function takeProgress(bytes) {
  const found = /^ (\d+);/.exec(text(bytes.slice(2)));
  if (found && profile?.length > 0)
    drawProfile($("profile"), profile, Number(found[1]));
}

// A question that is asked repeatedly: "40" is message 4, motor '0'.
async function poll(question, take) {
  const message = toHex([Number(question[0]), question.charCodeAt(1)]);
  const answer = await ask("request", { node: Number($("node").value), motor: 0, message, poll: true });
  if (answer.outcome === "answered")
    take(fromHex(answer.answer), answer.t_ms);
}

async function pollPositions() {
  if (!$("poll").checked)
    return;
  const begun = performance.now();
  if (open && $("node").value !== "0" && !document.hidden)
    await poll("40", takePositions);
  polling = setTimeout(pollPositions, Math.max(10, Number($("rate").value) - (performance.now() - begun)));
}

$("poll").onchange = () => {
  clearTimeout(polling);
  pollPositions();
};

// ---- Port ----

export function showPort(port) {
  open = port.port;
  $("connect-word").textContent = word(open ? "disconnect" : "connect");
  if (open) {
    $("port").value = open;
    $("framing").value = port.framing ?? "hdlc";
  }
  say(open ? word("connected", open) : word("closed"));
}

export async function findPorts() {
  const found = await ask("ports");
  if (!found.ports)
    return;
  const names = [...found.emulators.map((one) => one.port), ...found.ports.map((one) => one.port)].filter(Boolean);
  $("ports").replaceChildren(...names.map((name) => new Option(name)));
  if ($("port").value === "" && names.length > 0)
    $("port").value = names[0];
  tell("found", found.emulators);
}

async function toggleConnection() {
  const answer = open ? await ask("close")
    : await ask("open", { port: $("port").value.trim() || "-", framing: $("framing").value });
  if (answer.trouble || answer.error)
    say((answer.trouble ?? answer.error).trim(), true);
}

$("connection").onsubmit = (event) => {
  event.preventDefault();
  toggleConnection();
};
$("find").onclick = findPorts;

// ---- Requests ----

function chosenMessage() {
  const number = Number($("message").value), motor = 0x30 + Number($("motor").value);
  if (number === RAW)
    return $("raw").value.replace(/\s/g, "");
  return toHex(number === 1 ? [1] : [number, motor]);
}

async function sendRequest() {
  const number = Number($("message").value), target = { node: Number($("node").value), motor: Number($("motor").value) };
  const answer = number === 2 ? await ask("send", { ...target, text: $("text").value })
    : await ask("request", { ...target, message: chosenMessage() });
  $("progress").hidden = true;
  if (answer.error)
    addEntry(() => ({ head: `${word("refused")}: ${answer.error}` }), true);
}

$("request").onsubmit = (event) => {
  event.preventDefault();
  sendRequest();
};
// What depends on the language or on what is chosen.
export function showWords() {
  entries.forEach(fill);
  showChoices();
  if (profile === null)
    $("profile-text").textContent = word("profile-none");
  else
    $("profile-text").textContent = profileText || word("profile-empty");
}

function showChoices() {
  $("broadcast").hidden = $("node").value !== "0";
  $("raw-label").hidden = $("message").value !== String(RAW);
}
$("request").onchange = showChoices;

async function stopAll() {
  const begun = performance.now(), took = () => Math.round(performance.now() - begun);
  const [answer, units] = await Promise.all([ask("stop", { node: Number($("node").value) }), stopUnits()]);
  if (units.failed)
    say(word("stop-units-failed", units.failed, units.why), true);
  else if (answer.outcome === "sent")
    say(word("stop-done", took()));
  else if (units.done > 0)
    say(word("stop-units", units.done, took()));
  else
    say(word("stop-failed"), true);
}
$("stop").onclick = stopAll;

on("answer", takeAnswer);
on("port", (port) => { // what has not changed says nothing: it would cover what is said about a request
  if (port.port !== open)
    showPort(port);
});
on("progress", ({ sent, total }) => {
  $("progress").hidden = total === 0 || sent >= total;
  $("progress").max = Math.max(1, total);
  $("progress").value = sent;
});

export function begin(hello) {
  showPort(hello.port);
  showChoices();
  check();
  findPorts();
}

export const keys = {
  F2: () => $("connection").requestSubmit(),
  F8: stopAll,
  F9: () => $("poll").click(),
  "Control+Enter": () => $("request").requestSubmit(),
  "Control+o": () => $("open").click(),
  "Control+s": () => $("save").click(),
  "Alt+f": () => $("format").click(),
};
