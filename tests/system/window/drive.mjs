// SPDX-License-Identifier: MIT
// drive.mjs CASE ADDRESS FOLDER [PICTURES]: the window in headless Chromium, as a person uses it. NODE_PATH names playwright-core
// and axe-core. Waits are for conditions, with a limit.
import { createRequire } from "node:module";
import { readFileSync, writeFileSync } from "node:fs";
import { execFileSync, spawn } from "node:child_process";
import assert from "node:assert/strict";

const require = createRequire(process.env.NODE_PATH + "/");
const { chromium } = require("playwright-core");
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
const [, , name, address, folder, pictures] = process.argv;
const port = folder + "/bus";
const troubles = [];

async function openPage(context) {
  const page = await context.newPage();
  page.setDefaultTimeout(30000);
  page.on("pageerror", (error) => troubles.push(error.message));
  page.on("console", (message) => { if (message.type() === "error" && !/WebSocket/.test(message.text())) troubles.push(message.text()); });
  await page.goto(address);
  await page.waitForFunction(() => document.getElementById("status").textContent !== "" && document.querySelectorAll("#colours .c-move").length > 0);
  return page;
}

const says = (page, id, text) => page.waitForFunction(([at, part]) => document.getElementById(at).textContent.includes(part), [id, text]);
// Some element of the selector fulfils the condition: an expression, read outside of the page, whose policy has no eval.
async function shows(page, selector, condition = "true") {
  const end = Date.now() + 30000;
  const expression = `[...document.querySelectorAll(${JSON.stringify(selector)})].some((element) => ${condition})`;
  while (!await page.evaluate(expression)) {
    if (Date.now() > end)
      throw new Error(`not within 30 s: ${selector} with ${condition}`);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(done)));
  }
}

async function connect(page) {
  await page.fill("#port", port);
  await page.press("#port", "F2");
  await says(page, "status", port);
}

async function send(page, message, answer) {
  const before = await page.locator("#answers p").count();
  await page.selectOption("#message", message);
  await page.keyboard.press("Control+Enter");
  await page.waitForFunction(([count, text]) => [...document.querySelectorAll("#answers p")].slice(count).some((one) => one.textContent.includes(text)), [before, answer]);
}

async function write(page, text) {
  await page.fill("#text", text);
  await page.waitForFunction((wanted) => document.getElementById("colours").textContent.trim() === wanted.trim() && document.querySelector("#colours .c-word, #colours .c-error"), text);
}

async function openPanel(page) {
  await page.click("#tab-panel");
  await shows(page, "#inside", "!element.hidden");
  await shows(page, ".unit .motors td", "element.textContent === 'idle' || element.textContent === 'moving'");
}

// What axe-core finds.
async function checkAccess(page, what) {
  await page.evaluate(axe + ";0").catch(async () => page.addScriptTag({ content: axe }));
  const found = await page.evaluate(async () => (await window.axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"] })).violations
    .map((one) => `${one.id}: ${one.nodes.map((node) => node.target.join(" ") + " " + (node.any[0]?.message ?? "")).join("; ")}`));
  assert.deepEqual(found, [], what);
}

const cases = {
  // Each message of the service program, open and save, errors, format, search.
  async service(page) {
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
    const stopped = /in (\d+) ms/.exec(await page.textContent("#status"));
    assert.ok(Number(stopped[1]) < 1000, `stop took ${stopped[1]} ms`);
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

  // The editor: errors with their place, explanation, format, a file opened and saved; a text that looks like markup stays text.
  async editor(page) {
    await write(page, "F5000 R\nQ5");
    await shows(page, "#diagnostics .error", "element.textContent.startsWith('2:1 ')");
    await page.click("#diagnostics .error");
    assert.equal(await page.evaluate(() => document.getElementById("text").selectionStart), 8);
    await page.fill("#text", "S100   V1000 A2000 F5000 R");
    await says(page, "estimate", "5000 steps");
    await page.press("#text", "Alt+f");
    await page.waitForFunction(() => document.getElementById("text").value === "S100 V1000 A2000 F5000\nR\n" || document.getElementById("text").value === "S100 V1000 A2000 F5000 R\n");
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
    await page.fill("#fault input[name=input]", "5");
    await page.selectOption("#fault select[name=level]", "1");
    await page.press("#fault input[name=input]", "Enter");
    await shows(page, "#faults li", "element.textContent.includes('input=5')");
    await page.click("#clear-faults");
    await page.waitForFunction(() => document.querySelectorAll("#faults li").length === 0);
    writeFileSync(folder + "/axis.yaml", "motors:\n  1: {stops: {low: -50, high: 300000}}\nswitches:\n  - {input: 1, motor: 1, at_most: 0}\n");
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
    await page.close();
    await other.locator(".unit").first().getByRole("button", { name: "07", exact: true }).click();
    await shows(other, ".unit button[aria-pressed=false]", "element.textContent === '07'");
  },

  // With the keyboard alone: every control is reached by Tab, nothing holds the focus, a program is sent and stopped.
  async keyboard(page) {
    await page.keyboard.press("Tab");
    const seen = new Set();
    for (let at = 0; at < 60; at++) {
      seen.add(await page.evaluate(() => document.activeElement.id));
      await page.keyboard.press("Tab");
    }
    for (const id of ["tab-service", "stop", "language", "theme", "port", "framing", "connect", "find", "node", "motor", "message", "send", "open",
      "save", "format", "file-name", "text", "search", "save-answers", "clear", "answers", "poll", "rate"])
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

  // Both languages have all words; axe-core finds nothing, light and dark; pictures at three sizes.
  async looks(page) {
    await connect(page);
    await send(page, "2", "ok");
    await send(page, "6", "(5000;0)");
    await page.click("#poll");
    for (const language of ["cs", "en"]) {
      await page.selectOption("#language", language);
      await says(page, "send", language === "cs" ? "Odeslat" : "Send");
      assert.deepEqual(await page.evaluate(async () => (await import("./words.js")).missingWords), []);
      for (const theme of ["dark", "light"]) {
        await page.selectOption("#theme", theme);
        await page.click("#tab-service");
        await checkAccess(page, `service, ${language}, ${theme}`);
        await openPanel(page);
        await checkAccess(page, `panel, ${language}, ${theme}`);
      }
    }
    writeFileSync(folder + "/axis.yaml", "motors:\n  1: {stops: {low: -50, high: 300000}}\nswitches:\n  - {input: 1, motor: 1, at_most: 0}\n");
    await page.setInputFiles("#plant-file", folder + "/axis.yaml");
    await shows(page, ".axis input[type=range]");
    await checkAccess(page, "panel with an axis");
    await page.click("#tab-service");
    await write(page, "{ Drill: down, wait for the part, up }\n\\ C100 S200 V4000 A8000\nL20\n    F9000 R\n    T03 W300 C03\n    B9000 R\nE\n");
    await send(page, "2", "ok");
    await send(page, "6", "(9000;0)");
    await page.waitForFunction(() => Number(document.querySelector("#positions td").textContent) > 1000);
    for (const [size, width, height] of [["phone", 390, 844], ["desk", 1366, 900], ["4k", 3840, 2160]]) {
      await page.setViewportSize({ width, height });
      for (const view of ["service", "panel"]) {
        await page.click("#tab-" + view);
        const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
        assert.ok(wide <= 0, `${view} on ${size} is ${wide} pixels too wide`);
        await page.screenshot({ path: `${pictures || folder}/window-${view}-${size}.png`, fullPage: size === "phone" });
      }
    }
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

  // The page's size and time, and that a page that is not used is quiet.
  async size(page, context) {
    const other = await context.newPage();
    let bytes = 0;
    other.on("response", (response) => { bytes += Number(response.headers()["content-length"] ?? 0); });
    await other.goto(address);
    await other.waitForFunction(() => document.querySelectorAll("#colours .c-move").length > 0);
    await other.waitForLoadState("networkidle");
    console.log(`page: ${bytes} bytes`);
    assert.ok(bytes > 20000 && bytes < 200000, `${bytes} bytes`);
  },
};

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM || "/usr/bin/chromium", args: ["--no-sandbox"] });
let page;
try {
  const context = await browser.newContext({ viewport: { width: 1366, height: 900 }, locale: "en-GB", bypassCSP: name === "looks" });
  page = await openPage(context);
  await cases[name](page, context);
  assert.deepEqual(troubles, [], "errors of the page");
} catch (error) {
  await page?.screenshot({ path: `${process.env.FAILED || folder}/failed-${name}.png`, timeout: 5000 }).catch(() => {});
  console.error(error);
  process.exitCode = 1;
} finally {
  await browser.close();
}
