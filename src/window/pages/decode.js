// SPDX-License-Identifier: MIT
// Messages of the unit (specification section 3) as words. What a unit sends is text, whatever it looks like.
import { word } from "./words.js";

export const messages = ["Version", "Set Command", "Store Flash", "Get Position", "Get Command", "Get Tabul Run",
  "Get Pozic Run"];

export const fromHex = (hex) => Uint8Array.from((hex ?? "").match(/../g) ?? [], (pair) => parseInt(pair, 16));
export const toHex = (bytes) => Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
export const spaced = (hex) => (hex ?? "").replace(/..(?=.)/g, "$& ").toUpperCase();

export function text(bytes) {
  return Array.from(bytes, (byte) => byte >= 0x20 && byte < 0x7f ? String.fromCharCode(byte)
    : "\\x" + byte.toString(16).padStart(2, "0").toUpperCase()).join("");
}

export function motorName(byte) {
  return byte === 0x30 ? word("all") : byte >= 0x31 && byte <= 0x34 ? String(byte - 0x30) : "?";
}

// Fields of Get Position: a length and a number each.
export function readPositions(bytes) {
  const positions = [];
  for (let at = 2; at < bytes.length && bytes[at] > 0 && at + bytes[at] < bytes.length; at += bytes[at] + 1)
    positions.push(Number(text(bytes.slice(at + 1, at + 1 + bytes[at]))));
  return positions;
}

// " 3;[(1;100),(51;1000),…]" as pairs [step, speed].
export function readTable(bytes) {
  return Array.from(text(bytes.slice(2)).matchAll(/\((\d+);(\d+)\)/g), (found) => [Number(found[1]), Number(found[2])]);
}

export function describeRequest(bytes) {
  const name = messages[bytes[0] - 1] ?? String(bytes[0]);
  if (bytes[0] === 1 || bytes[0] > 7)
    return name;
  const rest = bytes[0] === 2 ? ` "${text(bytes.slice(2))}"` : "";
  return `${name} ${word("motor")} ${motorName(bytes[1])}${rest}`;
}

function describeFlag(bytes) {
  return word("flag" + bytes[2], bytes[3] > 0x20 ? text(bytes.slice(3, 4)) : String(bytes[3]));
}

export function describeAnswer(bytes) {
  const rest = bytes.slice(2);
  switch (bytes[0]) {
    case 1: return text(rest);
    case 2: return bytes.length >= 4 && bytes[2] <= 3 ? describeFlag(bytes) : text(rest);
    case 3: return bytes[2] === 0 ? word("stored") : word("not-stored", bytes[2]);
    case 4: return readPositions(bytes).join(", ");
    case 7: {
      const found = /^ (\d+); (\d+)$/.exec(text(rest));
      return found ? word("steps", found[1], found[2]) : text(rest);
    }
    case 255: return word("unknown", bytes[1]);
    default: return text(rest);
  }
}
