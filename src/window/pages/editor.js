// SPDX-License-Identifier: MIT
// The program text: colours, errors, explanations and the estimate come from the program tools of rkmctl window.
import { ask } from "./link.js";
import { languageName, word } from "./words.js";

const $ = (id) => document.getElementById(id);
const WAIT_MS = 150;
const area = $("text");
let known = { text: null, commands: [], diagnostics: [] };
let timer = 0;

// The tools count bytes of UTF-8: places of a string's characters by their bytes.
function places(text) {
  const map = new Map();
  let bytes = 0;
  for (let at = 0; at <= text.length; at++) {
    map.set(bytes, at);
    const code = text.codePointAt(at) ?? 0;
    bytes += code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
    if (code > 0xffff)
      at++;
  }
  return map;
}

function kindOf(command) {
  if ("RGH()".includes(command[0])) return "c-move";
  if ("OZW[]".includes(command[0])) return "c-wait";
  if ("@JI'.LE".includes(command[0])) return "c-jump";
  return "c-word";
}

function span(text, classes) {
  const element = document.createElement("span");
  element.textContent = text;
  element.className = classes;
  return element;
}

// Classes of each character, then one span for each run.
function paint() {
  const text = area.value;
  const classes = new Array(text.length).fill("");
  const mark = (from, to, name) => { for (let at = from; at < to; at++) classes[at] += " " + name; };
  if (known.text === text) {
    for (const [from, to] of known.commands)
      mark(from, to, kindOf(text.slice(from, to)));
    for (const one of known.diagnostics)
      mark(one.from, one.to, one.severity === "error" ? "c-error" : "c-warning");
    for (const comment of text.matchAll(/\{[^}]*\}?/g))
      mark(comment.index, comment.index + comment[0].length, "c-comment");
  }
  const parts = [];
  for (let at = 0; at < text.length;) {
    let end = at + 1;
    while (end < text.length && classes[end] === classes[at])
      end++;
    parts.push(span(text.slice(at, end), classes[at].trim()));
    at = end;
  }
  $("colours").replaceChildren(...parts, "\n");
  scroll();
}

function scroll() {
  $("colours").scrollTop = area.scrollTop;
  $("colours").scrollLeft = area.scrollLeft;
}

export function select(from, to) {
  area.focus();
  area.setSelectionRange(from, Math.max(to, from));
}

function showDiagnostics(answer) {
  const items = known.diagnostics.map((one) => {
    const item = document.createElement("li");
    const button = document.createElement("button");
    button.className = one.severity;
    button.textContent = `${one.line}:${one.column} ${one.message}${one.hint ? " – " + one.hint : ""}`;
    button.onclick = () => select(one.from, one.to);
    item.append(button);
    return item;
  });
  $("diagnostics").replaceChildren(...items);
  const errors = known.diagnostics.filter((one) => one.severity === "error").length;
  const state = items.length > 0 ? word("errors", errors, items.length - errors) : word("no-errors");
  $("estimate").textContent = answer.estimate ? `${state} ${answer.estimate.text}` : state;
}

export async function check() {
  const text = area.value;
  const answer = await ask("check", { text, language: languageName(), motor: Number($("motor").value) || 1 });
  if (!answer.commands || text !== area.value)
    return;
  const map = places(text);
  const place = (byte) => map.get(byte) ?? text.length;
  known = {
    text,
    commands: answer.commands.map(([offset, length, words]) => [place(offset), place(offset + length), words]),
    diagnostics: answer.diagnostics.map((one) => ({ ...one, from: place(one.offset),
      to: place(one.offset + Math.max(1, one.length)) })),
  };
  paint();
  showDiagnostics(answer);
  explain(area.selectionStart);
}

function explain(at) {
  const found = known.text === area.value ? known.commands.find(([from, to]) => at >= from && at <= to) : null;
  $("explanation").textContent = found ? `${area.value.slice(found[0], found[1])}: ${found[2]}` : "";
}

// The character below the mouse: all are of one width.
function characterAt(event) {
  const style = getComputedStyle(area);
  const canvas = characterAt.canvas ??= document.createElement("canvas").getContext("2d");
  canvas.font = `${style.fontSize} ${style.fontFamily}`;
  const column = Math.floor((event.offsetX + area.scrollLeft - parseFloat(style.paddingLeft)) / canvas.measureText("M").width);
  const line = Math.floor((event.offsetY + area.scrollTop - parseFloat(style.paddingTop)) / parseFloat(style.lineHeight));
  const lines = area.value.split("\n");
  if (line < 0 || line >= lines.length || column < 0 || column >= lines[line].length)
    return -1;
  return lines.slice(0, line).reduce((sum, one) => sum + one.length + 1, 0) + column;
}

export function setText(text) {
  area.value = text;
  changed();
}

function changed() {
  paint();
  clearTimeout(timer);
  timer = setTimeout(check, WAIT_MS);
}

export async function format() {
  const answer = await ask("format", { text: area.value });
  if (typeof answer.text === "string")
    setText(answer.text);
}

async function openFile() {
  const file = $("file").files[0];
  if (!file)
    return;
  const bytes = await file.arrayBuffer();
  let text;
  try {
    text = new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    text = new TextDecoder("windows-1250").decode(bytes);
  }
  setText(text.replace(/\r\n?/g, "\n"));
  $("file-name").value = file.name;
  $("file").value = "";
}

export function saveText(text, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

export const save = () => saveText(area.value, $("file-name").value || "program.rks");
export const open = () => $("file").click();

area.addEventListener("input", changed);
area.addEventListener("scroll", scroll);
document.addEventListener("selectionchange", () => { if (document.activeElement === area) explain(area.selectionStart); });
area.addEventListener("mousemove", (event) => {
  const at = characterAt(event);
  if (at >= 0)
    explain(at);
});
$("file").addEventListener("change", openFile);
$("open").onclick = open;
$("save").onclick = save;
$("format").onclick = format;
$("motor").addEventListener("change", check);
paint();
