// SPDX-License-Identifier: MIT
// Host software with node-serialport, as node.sh runs it: node_client.js WHAT PATH. An exception is a failed test.
"use strict";
const assert = require("assert");
const { SerialPort } = require("serialport");

const limit = 60000; // ms until an answer counts as never coming
// Frames of --framing plain: an unknown message, Get Position of motor 1, and the program F1 R for it.
const unknown = ["010001ff", "010004ffff0000"];
const position = ["0100020431", "01000d04310a20202020202020202030"];
const program = ["010006023146312052", "01000402310000"];

const call = (port, method, ...given) =>
    new Promise((well, wrong) => port[method](...given, (error, value) => (error ? wrong(error) : well(value))));

async function open(path, baudRate = 19200) {
    const port = new SerialPort({ path, baudRate, autoOpen: false });
    port.heard = "";
    port.on("data", (bytes) => { port.heard += bytes.toString("hex"); });
    await call(port, "open");
    return port;
}

async function ask(port, [request, wanted]) {
    const end = Date.now() + limit;
    port.heard = "";
    await call(port, "write", Buffer.from(request, "hex"));
    await call(port, "drain");
    while (port.heard.length < wanted.length && Date.now() < end)
        await new Promise((soon) => setTimeout(soon, 5));
    assert.strictEqual(port.heard, wanted);
}

const tests = {
    // Open, talk, close, and all that again.
    async talk(path) {
        for (let i = 0; i < 3; i++) {
            const port = await open(path);
            for (const exchange of i == 0 ? [unknown, position, program] : [unknown, program])
                await ask(port, exchange);
            await call(port, "flush");
            await call(port, "close");
        }
    },
    // The speed is changed while the port is open.
    async update(path) {
        const port = await open(path, 9600);
        await call(port, "update", { baudRate: 19200 });
        await ask(port, position);
        await call(port, "close");
    },
    // node-serialport locks what it has opened: a second one is told so.
    async lock(path) {
        const port = await open(path);
        await assert.rejects(open(path), /Cannot lock port/);
        await ask(port, unknown);
        await call(port, "close");
    },
};
tests[process.argv[2]](process.argv[3]).catch((error) => { console.error(error); process.exit(1); });
