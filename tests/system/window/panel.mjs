// SPDX-License-Identifier: MIT
// panel.mjs: the panel.
import { readFileSync, writeFileSync } from "node:fs";
import { execFileSync, spawn } from "node:child_process";
import assert from "node:assert/strict";
import { AXIS, connect, folder, openPanel, port, says, send, shows, write } from "./page.mjs";

export const cases = {
  // The panel: each switch and button, clock, snapshot, trace, faults, plant, dialogue.
  async panel(page) {
    await openPanel(page);
    const unit = page.locator(".unit").first();
    await unit.getByRole("button", { name: "03", exact: true }).click();
    await shows(page, ".unit button[aria-pressed=true]", "element.textContent === '03'");
    await page.click("#tab-service");
    await connect(page);
    await page.click("#tab-panel");
    await page.press("body", "F8");
    await shows(page, "#dialogue p", "element.textContent.includes('Set Command')");
    await page.click("#tab-service");
    await write(page, "\\ C100 S100 V1000 A2000 T02 T81 F200000 R");
    await send(page, "2", "ok");
    await page.click("#tab-panel");
    await shows(page, ".unit td", "element.textContent === 'moving'");
    await shows(page, ".unit .lamp.lit", "element.textContent === '02'");
    await shows(page, ".unit .lamp.lit", "element.textContent === '81'");
    await shows(page, ".unit .lamp.lit", "element.getAttribute('aria-label') === 'LED 1 1'");
    await page.selectOption("#clock", "stepped");
    await shows(page, "#steps button", "!element.disabled");
    await page.click("#snapshot");
    await says(page, "panel-text", "done");
    const before = await page.textContent("#time");
    await page.getByRole("button", { name: "+1s" }).click();
    await page.waitForFunction((text) => document.getElementById("time").textContent !== text, before);
    await page.click("#restore");
    await says(page, "panel-text", "Return");
    await page.click("#record");
    await says(page, "record", "Stop");
    await page.getByRole("button", { name: "+100ms" }).click();
    await page.click("#record");
    await shows(page, "#downloads a");
    const [trace] = await Promise.all([page.waitForEvent("download"), page.click("#downloads a")]);
    assert.match(readFileSync(await trace.path(), "utf8"), /step/);
    await page.click("#recording");
    await shows(page, "#downloads a", "element.textContent.endsWith('.record')");
    await page.selectOption("#fault select[name=kind]", "input");
    await page.selectOption("#fault select[name=input]", "5");
    await page.selectOption("#fault select[name=level]", "1");
    await page.press("#fault input[name=count]", "Enter");
    await shows(page, "#faults li", "element.textContent.includes('input=5')");
    await page.click("#clear-faults");
    await page.waitForFunction(() => document.querySelectorAll("#faults li").length === 0);
    writeFileSync(folder + "/axis.yaml", AXIS);
    await page.setInputFiles("#plant-file", folder + "/axis.yaml");
    await page.getByRole("button", { name: "+1ms" }).click();
    await shows(page, ".axis input[type=range]");
    await page.locator(".axis input[type=range]").first().fill("-40");
    await shows(page, ".axis .lamp.lit");
    await page.locator(".axis label.check").first().click();
    await page.getByRole("button", { name: "+1s" }).click();
    await page.click("#plant-none");
    await page.waitForFunction(() => document.querySelectorAll(".axis").length === 0);
    await unit.getByRole("button", { name: "4", exact: true }).click();
    await shows(page, ".unit legend", "element.textContent.includes('node 9')");
    await page.selectOption("#clock", "max");
    await unit.getByRole("button", { name: "Reset" }).click();
    await shows(page, ".unit td", "element.textContent === 'idle'");
    await unit.getByRole("button", { name: "Power" }).click();
    await shows(page, ".unit.off");
  },

  // Two clicks where one was meant start one trace; keys of the service view do nothing in this one, and a key that is held sends
  // once; the page zoomed to 400 % has room, and Stop all stays in sight.
  async mistakes(page) {
    const answers = () => page.locator("#answers p").count();
    await connect(page);
    await page.selectOption("#message", "1");
    await page.keyboard.down("Control");
    await page.keyboard.down("Enter");
    await page.keyboard.down("Enter"); // as a keyboard repeats it
    await page.keyboard.up("Enter");
    await page.keyboard.up("Control");
    await says(page, "answers", "01.02,06.03.2009");
    const before = await answers();
    await openPanel(page);
    await page.keyboard.press("Control+Enter");
    await page.keyboard.press("F2");
    await page.click("#tab-service");
    await says(page, "status", port);
    await page.click("#send");
    await page.waitForFunction((count) => document.querySelectorAll("#answers p").length > count, before);
    assert.equal(await answers() - before, before, "one request was sent by the key, none from the panel");
    await page.click("#tab-panel");
    await page.dblclick("#record");
    await says(page, "record", "Stop");
    await page.click("#record");
    await says(page, "record", "Start");
    await shows(page, "#downloads a");
    assert.equal(await page.locator("#downloads a").count(), 1);
    await page.setViewportSize({ width: 320, height: 256 });
    for (const view of ["service", "panel"]) {
      await page.click("#tab-" + view);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      assert.ok(wide <= 0, `${view} is ${wide} pixels too wide`);
      await page.evaluate(() => scrollTo(0, 600));
      assert.ok((await page.locator("header").boundingBox()).y < -100, "the head is scrolled away");
      const stop = await page.locator("#stop").boundingBox();
      assert.ok(stop.y > 0 && stop.y + stop.height <= 256 && stop.x + stop.width <= 320, "Stop all is in sight");
      await page.evaluate(() => scrollTo(0, 0));
    }
  },

  // A program listing with the present command in it, which follows the motor; and again after another program has come.
  async listing(page) {
    await connect(page);
    await write(page, "\\ C100 S100 V1000 A2000 T02\nO05 F10 R W60000");
    await send(page, "2", "ok");
    await openPanel(page);
    await page.click(".programs summary");
    await shows(page, ".listing [aria-current]", "element.textContent === 'O05'");
    assert.equal(await page.locator(".listing").first().textContent(), "C100 S100 V1000 A2000 T02 O05 F10 R\nW60000 ");
    await page.locator(".unit").first().getByRole("button", { name: "05", exact: true }).click();
    await shows(page, ".listing [aria-current]", "element.textContent === 'W60000'");
    await page.click("#tab-service");
    await write(page, "\\ " + "F1 ".repeat(600) + "O07");
    await send(page, "2", "ok");
    await page.click("#tab-panel");
    await shows(page, ".listing [aria-current]", "element.textContent === 'O07'");
    const box = await page.locator(".listing").first().boundingBox();
    const mark = await page.locator(".listing [aria-current]").boundingBox();
    assert.ok(mark.y >= box.y && mark.y + mark.height <= box.y + box.height, "the present command is in sight");
    await page.locator(".unit").first().getByRole("button", { name: "Reset" }).click();
    await shows(page, ".listing", "element.textContent === 'No program in memory.'");
  },

  // The axes of a plant: a slide between its stops, which it cannot leave, and a turntable; both dragged with the mouse.
  async axes(page) {
    await openPanel(page);
    writeFileSync(folder + "/axes.yaml", "motors:\n  1: {stops: {low: -50, high: 300}}\n  2: {turn: 400}\n  3: {offset: 7}\n"
      + "switches:\n  - {input: 1, motor: 1, at_most: 0}\n  - {input: 2, motor: 2, between: [100, 200]}\n");
    await page.setInputFiles("#plant-file", folder + "/axes.yaml");
    await shows(page, ".axis svg.slide .carriage");
    assert.equal(await page.locator(".axis").count(), 3);
    assert.deepEqual(await page.locator(".axis").first().locator("svg text").allTextContents(), ["DI 01", "-50", "300"]);
    assert.equal(await page.locator(".axis").nth(2).locator(".stop-block").count(), 0);
    const drag = async (axis, x, y) => {
      const box = await page.locator(".axis svg").nth(axis).boundingBox();
      await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
      await page.mouse.down();
      await page.mouse.move(box.x + box.width * x, box.y + box.height * y, { steps: 3 });
      await page.mouse.up();
    };
    await page.locator(".axis svg").first().scrollIntoViewIfNeeded();
    await drag(0, 0.999, 0.5);
    await shows(page, ".axis output", "element.textContent.startsWith('300 ')");
    await drag(0, 0.001, 0.5);
    await shows(page, ".axis output", "element.textContent.startsWith('-50 ')");
    await shows(page, ".axis .range.lit");
    await page.locator(".axis svg").nth(1).scrollIntoViewIfNeeded();
    await drag(1, 0.9, 0.9);
    await shows(page, ".axis output", "element.textContent.includes('(150/400)')");
    await shows(page, ".axis .arc.lit");
    await page.locator(".axis label.check").first().click();
    await shows(page, ".axis .carriage.held");
    assert.equal(await page.textContent("#panel-text"), "");
  },

  // Faults of the flash and of the power, given in the form, act on what the service view does.
  async faults(page) {
    await connect(page);
    await write(page, "\\ C100 T03");
    await send(page, "2", "ok");
    await openPanel(page);
    await shows(page, "#fault select[name=kind] option");
    const kinds = await page.locator("#fault select[name=kind] option").allTextContents();
    assert.equal(kinds.length, 15);
    for (const kind of kinds) {
      await page.selectOption("#fault select[name=kind]", kind);
      await shows(page, "#fault [name=probability]");
    }
    await page.selectOption("#fault select[name=kind]", "flash");
    await page.selectOption("#fault select[name=operation]", "write");
    await page.fill("#fault input[name=count]", "1");
    await page.press("#fault input[name=count]", "Enter");
    await shows(page, "#faults li", "element.textContent.includes('flash: armed')");
    await page.click("#tab-service");
    await send(page, "3", "flash error");
    await page.click("#tab-panel");
    await shows(page, "#faults li", "element.textContent.includes('flash: spent')");
    await page.selectOption("#fault select[name=kind]", "power");
    await page.fill("#fault input[name=operation]", "1");
    await page.press("#fault input[name=operation]", "Enter");
    await shows(page, "#faults li", "element.textContent.includes('power: armed')");
    await page.click("#tab-service");
    await send(page, "3", "no answer");
    await page.click("#tab-panel");
    await shows(page, ".unit.off");
    await page.click("#clear-faults");
    await page.waitForFunction(() => document.querySelectorAll("#faults li").length === 0);
    await page.selectOption("#fault select[name=kind]", "delay");
    await page.click("#fault button"); // its delay is missing: the browser says so, nothing is sent
    assert.equal(await page.evaluate(() => document.querySelector("#fault [name=delay]").validity.valueMissing), true);
    assert.equal(await page.textContent("#panel-text"), "");
  },

  // Two buses of one emulator: each with its own units.
  async buses(page) {
    await openPanel(page);
    await shows(page, ".unit h2", "element.textContent === 'Unit 1'");
    assert.equal(await page.locator(".unit").count(), 2);
    await page.locator(".unit").first().getByRole("button", { name: "03", exact: true }).click();
    await shows(page, ".unit button[aria-pressed=true]", "element.textContent === '03'");
    await page.fill("#bus", "1");
    await page.click("#attach");
    await page.waitForFunction(() => document.querySelectorAll(".unit button[aria-pressed=true]").length > 0
      && ![...document.querySelectorAll(".unit button[aria-pressed=true]")].some((one) => one.textContent === "03"));
    assert.equal(await page.locator(".unit").count(), 2);
    await page.locator(".unit").nth(1).getByRole("button", { name: "06", exact: true }).click();
    await shows(page, ".unit button[aria-pressed=true]", "element.textContent === '06'");
    await page.fill("#bus", "0");
    await page.click("#attach");
    await shows(page, ".unit button[aria-pressed=true]", "element.textContent === '03'");
    await page.fill("#bus", "7");
    await page.click("#attach");
    await says(page, "emulator-text", "there is no bus 7");
  },

  // The emulator ends, and another one comes in its place; the same with the port.
  async loss(page) {
    await connect(page);
    await openPanel(page);
    execFileSync(process.env.RKMCTL, ["-c", port + ".control", "shutdown"]);
    await says(page, "emulator-text", "ended");
    await shows(page, "#inside", "element.hidden");
    const again = spawn(process.env.RKM04, ["serve", "--link", port], { stdio: "ignore" });
    try {
      await shows(page, "#inside", "!element.hidden");
      await shows(page, ".unit td", "element.textContent === 'idle'");
      await page.click("#tab-service");
      await page.selectOption("#message", "1");
      await page.click("#send");
      await says(page, "answers", "closed at its other end");
      await says(page, "status", "No port is open.");
      await connect(page);
      await send(page, "1", "01.02,06.03.2009");
      process.kill(Number(process.env.WINDOW_PID));
      await says(page, "status", "is lost");
    } finally {
      again.kill();
    }
  },
};
