// SPDX-License-Identifier: MIT
// The WebSocket to rkmctl window: requests with their answers, events, and a new connection when it was lost.
const RETRY_MS = 1000;
const listeners = {};
let socket = null;
let last = 0;
const pending = new Map();
const called = new Map();

export function on(name, listener) { (listeners[name] ??= []).push(listener); }

export function tell(name, value) {
  for (const listener of listeners[name] ?? [])
    listener(value);
}

function settle(map, id, value) {
  map.get(id)?.(value);
  map.delete(id);
}

function take(object) {
  if (object.event === "called") {
    const { id, result, error } = object.answer;
    settle(called, id, error ? { error: error.message } : { ...result, error: undefined }); // `error` is that of a refusal alone
  } else if (object.event === "uncalled") {
    for (const id of [...called.keys()])
      settle(called, id, { error: "" });
  } else if (object.event) {
    tell(object.event, object);
  } else {
    settle(pending, object.id, object);
    if (object.error !== undefined)
      settle(called, object.id, object);
  }
}

// Whole numbers that a double cannot hold stay texts, in answers that cells may have.
function parse(text) {
  const keep = (_, value, source) =>
    Number.isInteger(value) && !Number.isSafeInteger(value) && source?.source ? source.source : value;
  return text.startsWith('{"event":"called"') && /\d{16}/.test(text) ? JSON.parse(text, keep) : JSON.parse(text);
}

export function connect() {
  socket = new WebSocket(`ws://${location.host}/socket`, "rkm04-window");
  socket.onopen = () => tell("open");
  socket.onmessage = (message) => take(parse(message.data));
  socket.onclose = () => {
    for (const map of [pending, called])
      for (const id of [...map.keys()])
        settle(map, id, { error: "", outcome: "lost" });
    tell("close");
    setTimeout(connect, RETRY_MS);
  };
}

function request(map, object) {
  return new Promise((resolve) => {
    const id = ++last;
    if (socket?.readyState !== WebSocket.OPEN)
      return resolve({ error: "", outcome: "lost" });
    map.set(id, resolve);
    socket.send(JSON.stringify({ id, ...object }));
  });
}

// A request to rkmctl window; a method of the emulator's control socket.
export const ask = (name, parameters = {}) => request(pending, { do: name, ...parameters });
export const call = (method, params = {}) => request(called, { do: "call", method, params });
