// SPDX-License-Identifier: MIT
// page.mjs: what the cases share: the page in headless Chromium, as a person uses it. Waits are for conditions, with a limit.
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";
import assert from "node:assert/strict";

const require = createRequire(process.env.NODE_PATH + "/");
export const { chromium } = require("playwright-core");
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
export const [, , name, address, folder, pictures] = process.argv;
export const port = process.env.WINDOW_PORT ?? folder + "/bus";
export const troubles = [];

export async function openPage(context) {
  const page = await context.newPage();
  page.setDefaultTimeout(60000);
  page.on("pageerror", (error) => troubles.push(error.message));
  page.on("console", (message) => {
    if (message.type() === "error" && !/WebSocket/.test(message.text()))
      troubles.push(message.text());
  });
  await page.goto(address);
  await page.waitForFunction(() => document.getElementById("status").textContent !== ""
    && document.querySelectorAll("#colours .c-move").length > 0);
  return page;
}

export const says = (page, id, text) => page.waitForFunction(([at, part]) =>
  document.getElementById(at).textContent.includes(part), [id, text]);

// Some element of the selector fulfils the condition: an expression, read outside of the page, whose policy has no eval.
export async function shows(page, selector, condition = "true") {
  const end = Date.now() + 60000;
  const expression = `[...document.querySelectorAll(${JSON.stringify(selector)})].some((element) => ${condition})`;
  while (!await page.evaluate(expression)) {
    if (Date.now() > end)
      throw new Error(`not within 60 s: ${selector} with ${condition}`);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(done)));
  }
}

export async function connect(page) {
  await page.fill("#port", port);
  await page.press("#port", "F2");
  await says(page, "status", port);
}

export async function send(page, message, answer) {
  const before = await page.locator("#answers p").count();
  await page.selectOption("#message", message);
  await page.keyboard.press("Control+Enter");
  await page.waitForFunction(([count, text]) =>
    [...document.querySelectorAll("#answers p")].slice(count).some((one) => one.textContent.includes(text)), [before, answer]);
}

export async function write(page, text) {
  await page.fill("#text", text);
  await page.waitForFunction((wanted) => document.getElementById("colours").textContent.trim() === wanted.trim()
    && document.querySelector("#colours .c-word, #colours .c-error"), text);
}

export async function openPanel(page) {
  await page.click("#tab-panel");
  await shows(page, "#inside", "!element.hidden");
  await shows(page, ".unit .motors td", "element.textContent === 'idle' || element.textContent === 'moving'");
}

// Another language. At once, before anything is read again, each control has a name and each table still has its values.
export async function changeLanguage(page, language) {
  const [nameless, emptied] = await page.evaluate((wanted) => {
    const seen = (selector) => [...document.querySelectorAll(selector)].filter((element) => element.offsetParent !== null);
    const filled = () => seen("table").map((table) => [...table.tBodies].flatMap((body) => [...body.rows])
      .map((row) => [...row.cells].map((cell) => [cell, ...cell.querySelectorAll("input, select")]
        .some((element) => (element.value ?? element.textContent) !== "")).join()));
    const before = filled();
    const select = document.getElementById("language");
    select.value = wanted;
    select.dispatchEvent(new Event("change"));
    const after = filled();
    return [seen("button, input, select, textarea").filter((one) => ![one.textContent, one.getAttribute("aria-label"), one.title,
      ...[...one.labels ?? []].map((label) => label.textContent)].some((text) => text?.trim())).map((one) => one.outerHTML),
    before.flatMap((rows, at) => rows.filter((row, line) => row !== after[at]?.[line])
      .map((row) => `table ${at}: ${row}, then ${after[at]}`))];
  }, language);
  assert.deepEqual(nameless, [], "controls without a name");
  assert.deepEqual(emptied, [], "values that are gone");
}

// Stop all, with devices that are stopped by their units: once more if one was too late with its answer, on a busy machine.
export async function stopUnits(page) {
  for (let tries = 0; tries < 10; tries++) {
    await page.evaluate(() => { document.getElementById("status").textContent = ""; });
    await page.keyboard.press("F8");
    await shows(page, "#status", "/Stop (sent to|was not done by) units: 1/.test(element.textContent)");
    if ((await page.textContent("#status")).includes("Stop sent to units: 1"))
      return;
  }
  throw new Error("no unit is stopped in time, of ten times");
}

// Milliseconds in which rkmctl window answers a request that it need not think about, on this machine, now.
export const roundTrip = (page) => page.evaluate(async () => {
  const { ask } = await import("./link.js"), begun = performance.now();
  await ask("hello");
  return performance.now() - begun;
});

// Has this machine other work, now? A figure of time says nothing then. It has if 0.3 s of work take longer.
export function isBusy() {
  const work = 300000, begun = performance.now(), before = process.cpuUsage();
  let spent;
  do {
    spent = process.cpuUsage(before);
  } while (spent.user + spent.system < work);
  return performance.now() - begun > 1.2 * work / 1000;
}

// What axe-core finds.
export async function checkAccess(page, what) {
  await page.evaluate(axe + ";0").catch(async () => page.addScriptTag({ content: axe }));
  const found = await page.evaluate(async () => {
    const { violations } = await window.axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"] });
    const place = (node) => `${node.target.join(" ")} ${node.any[0]?.message ?? ""}`;
    return violations.map((one) => `${one.id}: ${one.nodes.map(place).join("; ")}`);
  });
  assert.deepEqual(found, [], what);
}

// A plant of one axis with end stops and a switch.
export const AXIS = "motors:\n  1: {stops: {low: -50, high: 300000}}\nswitches:\n  - {input: 1, motor: 1, at_most: 0}\n";
