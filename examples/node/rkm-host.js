// SPDX-License-Identifier: MIT
// A small host library for the RKM04, with node-serialport. It knows nothing of the emulator.
"use strict";
const { SerialPort } = require("serialport");

const FLAG = 0x7e, ESCAPE = 0x7d;
const VERSION = 1, SET_COMMAND = 2, GET_POSITION = 4, GET_PROGRESS = 7;

function fcs16(bytes) {
    let value = 0xffff;
    for (const byte of bytes) {
        value ^= byte;
        for (let bit = 0; bit < 8; bit++)
            value = (value >> 1) ^ (value & 1 ? 0x8408 : 0);
    }
    return value ^ 0xffff;
}

function frame(node, message) {
    const body = [node, 0, ...message];
    const check = fcs16(body);
    body.push(check & 0xff, check >> 8);
    return Buffer.from([FLAG, ...body.flatMap((byte) => byte === FLAG || byte === ESCAPE ? [ESCAPE, byte ^ 0x20] : [byte]), FLAG]);
}

// The body of what is between two flags; null: not a valid frame.
function unframe(bytes) {
    const body = [];
    let escaped = false;
    for (const byte of bytes) {
        if (byte === ESCAPE) {
            escaped = true;
        } else {
            body.push(escaped ? byte ^ 0x20 : byte);
            escaped = false;
        }
    }
    if (body.length < 5 || fcs16(body.slice(0, -2)) !== (body[body.length - 2] | body[body.length - 1] << 8))
        return null;
    return body.slice(0, -2);
}

class NoAnswer extends Error {}
class Refused extends Error {}

// One unit on a bus; made by `await Unit.open(path)`. node: 1 to 16; timeout: ms to wait for an answer; retries: how often a
// request without an answer is sent again.
class Unit {
    static async open(path, { node = 1, timeout = 500, retries = 2 } = {}) {
        const unit = new Unit();
        Object.assign(unit, { node, timeout, retries, heard: [], wanted: null });
        unit.port = new SerialPort({ path, baudRate: 19200, autoOpen: false });
        unit.port.on("data", (bytes) => bytes.forEach((byte) => unit.hear(byte)));
        await new Promise((done, fail) => unit.port.open((error) => error ? fail(error) : done()));
        return unit;
    }

    close() {
        return new Promise((done) => this.port.close(done));
    }

    hear(byte) {
        if (byte !== FLAG) {
            this.heard.push(byte);
            return;
        }
        const body = unframe(this.heard);
        this.heard = [];
        if (body && this.wanted && this.wanted.head.every((wanted, i) => body[i] === wanted))
            this.wanted.done(Buffer.from(body.slice(3)));
    }

    // Send a message; resolves to what follows the number in the answer.
    async request(number, rest = "") {
        const text = Buffer.from(rest, "ascii");
        const head = [0, this.node, number, ...(number === VERSION ? [] : text.subarray(0, 1))];
        for (let attempt = 0; attempt <= this.retries; attempt++) {
            const answer = await new Promise((done) => {
                const timer = setTimeout(() => done(null), this.timeout);
                this.wanted = { head, done: (bytes) => { clearTimeout(timer); done(bytes); } };
                this.port.write(frame(this.node, [number, ...text]));
            });
            this.wanted = null;
            if (answer)
                return answer;
        }
        throw new NoAnswer(`unit ${this.node} does not answer message ${number}`);
    }

    async version() {
        return (await this.request(VERSION)).subarray(1).toString("ascii");
    }

    async setCommand(motor, text) {
        const answer = await this.request(SET_COMMAND, `${motor}${text}`);
        if (answer[1])
            throw new Refused(`motor ${motor}: ${text} is refused with flag ${answer[1]} at ${String.fromCharCode(answer[2])}`);
    }

    async position(motor) {
        return parseInt((await this.request(GET_POSITION, `${motor}`)).subarray(2).toString("ascii"), 10);
    }

    // Wait until the motor stands.
    async wait(motor) {
        while (parseInt((await this.request(GET_PROGRESS, `${motor}`)).toString("ascii").split(";")[1], 10))
            await new Promise((soon) => setTimeout(soon, 10));
    }
}

module.exports = { Unit, NoAnswer, Refused };
