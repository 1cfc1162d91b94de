// SPDX-License-Identifier: MIT
// Tests of rkm-host.js: npm install && npm test. Each test has an `rkm04 serve' of its own; motions take no time (--clock max).
// The environment variables RKM04 and RKMCTL name the programs; default: those in PATH.
"use strict";
const assert = require("node:assert");
const { execFileSync, spawn } = require("node:child_process");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { once } = require("node:events");
const { afterEach, beforeEach, test } = require("node:test");
const { NoAnswer, Refused, Unit } = require("../rkm-host.js");

let folder, server, unit;
const ctl = (...words) =>
    execFileSync(process.env.RKMCTL || "rkmctl", ["--control", path.join(folder, "bus.control"), ...words]);

beforeEach(async () => {
    folder = fs.mkdtempSync(path.join(os.tmpdir(), "rkm-host-"));
    const link = path.join(folder, "bus");
    server = spawn(process.env.RKM04 || "rkm04", ["serve", "--clock", "max", "--link", link], { stdio: ["ignore", "pipe", "ignore"] });
    await once(server.stdout, "data"); // READY
    unit = await Unit.open(link);
});

afterEach(async () => {
    await unit.close();
    server.kill();
    await once(server, "exit");
    fs.rmSync(folder, { recursive: true });
});

test("version", async () => {
    assert.strictEqual(await unit.version(), "01.02,06.03.2009");
});

test("a motion", async () => {
    await unit.setCommand(1, "V1000 F300 R");
    await unit.wait(1);
    assert.strictEqual(await unit.position(1), 300);
});

test("a text that is refused", async () => {
    await assert.rejects(unit.setCommand(1, "F5x"), Refused);
});

test("a lost answer is asked for again", async () => {
    ctl("fault", "inject", "no_answer", "count=1");
    assert.strictEqual(await unit.position(1), 0);
});

test("a unit without power", async () => {
    ctl("power", "off");
    unit.timeout = 50;
    await assert.rejects(unit.position(1), NoAnswer);
});
