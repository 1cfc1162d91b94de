// SPDX-License-Identifier: MIT
// service.mjs: the service view.
import { readFileSync, writeFileSync } from "node:fs";
import assert from "node:assert/strict";
import { AXIS, changeLanguage, connect, folder, openPage, openPanel, port, roundTrip, says, send, shows,
  write } from "./page.mjs";

export const cases = {
  // Each message of the service program, open and save, errors, format, search.
  async service(page) {
    await page.press("body", "F8");
    await says(page, "status", "Stop could not be sent");
    await page.evaluate(async () => (await import("./link.js")).ask("hello")); // answered after all that the stop has led to
    await says(page, "status", "Stop could not be sent");
    await connect(page);
    await send(page, "1", "01.02,06.03.2009");
    await write(page, "\\ C100 S100 V1000 A2000\nF60000 R");
    await send(page, "2", "ok");
    await send(page, "6", "(60000;0)");
    await shows(page, "#profile .mark");
    await send(page, "7", "steps done");
    await send(page, "4", "Get Position");
    await send(page, "5", "F60000 R");
    await send(page, "3", "stored in flash");
    await page.selectOption("#message", "0");
    await page.fill("#raw", "08");
    await page.click("#send");
    await says(page, "answers", "unknown message 8");
    await page.click("#poll");
    await shows(page, "#positions td", "Number(element.textContent) > 0");
    await page.press("body", "F8");
    await says(page, "status", "Stop sent");
    await page.click("#poll");
    await page.fill("#search", "stored in flash");
    await page.waitForFunction(() => [...document.querySelectorAll("#answers p")].filter((one) => !one.hidden).length === 1);
    await page.fill("#search", "");
    await page.selectOption("#node", "0");
    await shows(page, "#broadcast", "!element.hidden");
    await send(page, "4", "sent");
    await page.selectOption("#node", "9");
    await send(page, "4", "no answer");
    const [saved] = await Promise.all([page.waitForEvent("download"), page.click("#save-answers")]);
    assert.match(readFileSync(await saved.path(), "utf8"), /Get Tabul Run/);
    await page.click("#clear");
    assert.equal(await page.locator("#answers p").count(), 0);
    await page.press("body", "F2");
    await says(page, "status", "No port is open.");
  },

  // Stop all answers within 100 ms, and the motors stop, while a request waits for a unit that does not answer and positions are
  // asked repeatedly. The middle one of five counts, less the time that any answer takes: the machine may be busy.
  async stop(page) {
    await connect(page);
    const times = [];
    for (let round = 0; round < 5; round++) {
      await page.selectOption("#node", "1");
      await write(page, "\\ C100 S100 V1000 A20000 G+" + " ".repeat(round)); // another text: it is painted anew
      await send(page, "2", "ok");
      if (!await page.isChecked("#poll"))
        await page.press("body", "F9");
      await page.waitForFunction(() => Number(document.querySelector("#positions td").textContent) > 0);
      await page.selectOption("#node", "9");
      await page.selectOption("#message", "1");
      await page.press("body", "Control+Enter");
      await page.selectOption("#node", "1");
      await page.evaluate(() => { document.getElementById("status").textContent = ""; });
      await page.press("body", "F8");
      await says(page, "status", "Stop sent");
      const took = Number(/in (\d+) ms/.exec(await page.textContent("#status"))[1]);
      times.push(Math.round(took - await roundTrip(page)));
      await page.waitForFunction(() => {
        const cell = document.querySelector("#positions td"), before = cell.textContent;
        return new Promise((done) => setTimeout(() => done(Number(before) > 0 && cell.textContent === before), 700));
      });
    }
    console.log(`stop all: ${times.join(", ")} ms`);
    assert.ok(times.sort((a, b) => a - b)[2] <= 100, `stop all took ${times.join(", ")} ms`);
  },

  // The editor: errors with their place, explanation, format, a file opened and saved; a text that looks like markup stays text.
  async editor(page) {
    await write(page, "F5000 R\nQ5");
    await shows(page, "#diagnostics .error", "element.textContent.startsWith('2:1 ')");
    await page.click("#diagnostics .error");
    assert.equal(await page.evaluate(() => document.getElementById("text").selectionStart), 8);
    await page.fill("#text", "S100   V1000 A2000 F5000 R");
    await says(page, "estimate", "5000 steps");
    await page.press("#text", "Alt+f");
    await page.waitForFunction(() =>
      ["S100 V1000 A2000 F5000\nR\n", "S100 V1000 A2000 F5000 R\n"].includes(document.getElementById("text").value));
    await page.evaluate(() => document.getElementById("text").setSelectionRange(1, 1));
    await says(page, "explanation", "S100:");
    await page.hover("#text", { position: { x: 60, y: 15 } });
    await says(page, "explanation", "V1000:");
    writeFileSync(folder + "/opened.rks", "{ <img src=x onerror=alert(1)> žluť }\nF7 R\n");
    await page.setInputFiles("#file", folder + "/opened.rks");
    await says(page, "colours", "F7 R");
    assert.equal(await page.locator("#colours img").count(), 0);
    assert.equal(await page.inputValue("#file-name"), "opened.rks");
    const [saved] = await Promise.all([page.waitForEvent("download"), page.press("#text", "Control+s")]);
    assert.equal(readFileSync(await saved.path(), "utf8"), readFileSync(folder + "/opened.rks", "utf8"));
    await connect(page);
    await page.fill("#text", "\\ C100 " + "F1 ".repeat(600) + "W1");
    await page.selectOption("#message", "2");
    await page.click("#send");
    await says(page, "answers", "ok");
  },

  // With the keyboard alone: every control is reached by Tab, nothing holds the focus, a program is sent and stopped.
  async keyboard(page) {
    await page.keyboard.press("Tab");
    const seen = new Set();
    for (let at = 0; at < 60; at++) {
      seen.add(await page.evaluate(() => document.activeElement.id));
      await page.keyboard.press("Tab");
    }
    const ids = `tab-service stop language theme port framing connect find node motor message send open
      save format file-name text search save-answers clear answers poll rate`;
    for (const id of ids.split(/\s+/))
      assert.ok(seen.has(id), `${id} is not reached by Tab`);
    await page.focus("#port");
    await page.keyboard.press("Control+a");
    await page.keyboard.type(port);
    await page.keyboard.press("F2");
    await says(page, "status", port);
    await page.keyboard.press("Control+Enter");
    await says(page, "answers", "ok");
    await page.keyboard.press("F9");
    await shows(page, "#positions td", "Number(element.textContent) > 0");
    await page.keyboard.press("F8");
    await says(page, "status", "Stop sent");
    await page.focus("#tab-service");
    await page.keyboard.press("ArrowRight");
    await shows(page, "#panel", "!element.hidden");
    assert.equal(await page.evaluate(() => document.activeElement.id), "tab-panel");
  },

  // Two pages at once: both hear of the port and of answers.
  async pages(page, context) {
    const other = await openPage(context);
    await connect(page);
    await says(other, "status", port);
    await send(page, "1", "01.02,06.03.2009");
    await says(other, "answers", "01.02,06.03.2009");
    await openPanel(page);
    await openPanel(other);
    await page.locator(".unit").first().getByRole("button", { name: "07", exact: true }).click();
    await shows(other, ".unit button[aria-pressed=true]", "element.textContent === '07'");
    // What has no event of its own: a jam, a fault.
    writeFileSync(folder + "/axis.yaml", AXIS);
    await page.setInputFiles("#plant-file", folder + "/axis.yaml");
    await shows(other, ".axis svg .carriage");
    await page.locator(".axis label.check").first().click();
    await shows(other, ".axis svg .carriage.held");
    await page.selectOption("#fault select[name=kind]", "flash");
    await page.press("#fault input[name=count]", "Enter");
    await shows(other, "#faults li", "element.textContent.includes('flash: armed')");
    await page.close();
    await other.locator(".unit").first().getByRole("button", { name: "07", exact: true }).click();
    await shows(other, ".unit button[aria-pressed=false]", "element.textContent === '07'");
  },

  // A change of the language translates what is in the logs, too.
  async language(page) {
    await connect(page);
    await send(page, "2", "ok");
    await openPanel(page);
    await page.press("body", "F8");
    await shows(page, "#dialogue p", "element.textContent.includes('answers')");
    await changeLanguage(page, "cs");
    await says(page, "answers", "v pořádku");
    await says(page, "dialogue", "odpovídá");
    assert.doesNotMatch(await page.textContent("#answers"), /round trip|: ok/);
    assert.doesNotMatch(await page.textContent("#dialogue"), /answers|: ok/);
    await changeLanguage(page, "en");
    await says(page, "answers", "round trip");
    assert.doesNotMatch(await page.textContent("#answers"), /v pořádku/);
  },
};
