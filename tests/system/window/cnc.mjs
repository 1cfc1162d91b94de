// SPDX-License-Identifier: MIT
// cnc.mjs: the panel of a CNC872, a device without a bus.
import { execFile, execFileSync, spawn } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import assert from "node:assert/strict";
import { changeLanguage, checkAccess, folder, openPage, openPanel, pictures, roundTrip, shows, stopUnits } from "./page.mjs";

const quoted = (text) => JSON.stringify(text);
const reads = (page, row, column, text) => shows(page, `.axes tbody tr:nth-child(${row}) td:nth-child(${column})`,
  `element.textContent === ${quoted(text)}`);
const button = (page, name) => page.locator(".device").getByRole("button", { name, exact: true });
const says = (page, text) => shows(page, ".device > p[role=status]", `element.textContent.includes(${quoted(text)})`);
const line = (page, name, text) => shows(page, ".device dl.lines div",
  `element.textContent.startsWith(${quoted(name)}) && element.textContent.includes(${quoted(text)})`);
const pressed = (page, name, on = true) => shows(page, ".device button",
  `element.textContent === ${quoted(name)} && element.getAttribute('aria-pressed') === '${on}'`);
const value = (page, name, text) => shows(page, "table.cells tbody tr", `element.firstChild.textContent === ${quoted(name)}
  && (element.children[2].firstChild?.value ?? '') + element.children[2].textContent === ${quoted(text)}`);

async function add(page, names) {
  await page.fill(".cells input[list]", names);
  await page.press(".cells input[list]", "Enter");
}

// Press a key with the mouse and see its axis move.
async function hold(page, name, row) {
  await button(page, name).hover();
  await page.mouse.down();
  await reads(page, row, 2, "manual");
}

export const cases = {
  // What a device without a bus has, and what not: no dialogue, no faults of a bus, no plant; the panel is shown at first.
  async nobus(page) {
    await shows(page, "#inside", "!element.hidden && document.getElementById('service').hidden");
    await shows(page, "#fault select[name=kind] option");
    assert.deepEqual(await page.locator("#fault select[name=kind] option").allTextContents(), ["flash", "power"]);
    for (const part of ["#dialogue", "#plant-open", "#plant-none"])
      assert.equal(await page.locator(part).isVisible(), false, part);
    const kinds = await page.locator("#record-kind option:not([hidden])").allTextContents();
    assert.deepEqual(kinds, ["csv", "vcd", "jsonl"]);
    await page.click("#tab-service"); // it stays reachable
    await shows(page, "#service", "!element.hidden");
  },

  // Axes, keys that are held, START and STOP, pots, switches, the path.
  async cnc(page) {
    await shows(page, ".axes td", "element.textContent === 'X'");
    const above = (row, low) => shows(page, `.axes tbody tr:nth-child(${row}) td:nth-child(3)`,
      `Number(element.textContent) > ${low}`);
    assert.equal(await page.locator(".axes tbody tr").count(), 3);
    await line(page, "Block", "idle, block –, line –, next 0 of 2");
    // The program, slowly at first: STOP stops it, START goes on, with an override and at its end.
    await page.locator(".device input[aria-label='Feed %']").fill("1");
    await line(page, "Feed", "0.0 mm/min, 1 %, mode aut");
    await button(page, "START").click();
    await reads(page, 1, 2, "block");
    await line(page, "Block", "move, block 0, line 1");
    await line(page, "Feed", "6.0 mm/min, 1 %, mode aut");
    await above(1, 0.01);
    await button(page, "START").click();
    await shows(page, ".device > p[role=status].wrong");
    await button(page, "STOP").click();
    await reads(page, 1, 2, "stopped");
    await line(page, "Stops", "po_stop sf_stop");
    await page.locator(".device input[aria-label='Feed %']").fill("20"); // a quarter of a minute
    await line(page, "Feed", "0.0 mm/min, 20 %");
    await button(page, "START").click();
    await line(page, "Feed", "120.0 mm/min, 20 %");
    await page.locator(".device input[aria-label='Feed %']").fill("200");
    await line(page, "Feed", ", 200 %");
    await reads(page, 1, 3, "30.000");
    await reads(page, 2, 3, "2.000");
    await reads(page, 1, 2, "idle");
    // The path has been drawn: both legs of it; of other axes, too.
    await shows(page, ".path .note", "element.textContent === 'X 0.000 … 30.000\\nY 0.000 … 2.000'");
    assert.ok((await page.locator("svg.path path").getAttribute("d")).split("L").length > 4);
    await page.selectOption(".path select[aria-label=Up]", "Z");
    await shows(page, ".path .note", "element.textContent === 'X 0.000 … 30.000\\nZ 0.000 … 0.000'");
    await button(page, "Clear").first().click();
    await shows(page, ".path .note", "element.textContent === 'X 30.000 … 30.000\\nZ 0.000 … 0.000'");
    // Manual: a key moves its axis while it is held, by mouse and by keyboard.
    await page.selectOption(".device select[aria-label=Mode]", "manual");
    await hold(page, "Y−", 2);
    await pressed(page, "Y−");
    await page.mouse.up();
    await reads(page, 2, 2, "idle");
    await button(page, "Z+").focus();
    await page.keyboard.down("Space");
    await reads(page, 3, 2, "manual");
    await page.keyboard.up("Space");
    await reads(page, 3, 2, "idle");
    await button(page, "block by block").click();
    await pressed(page, "block by block");
    await button(page, "RESET").click();
    await line(page, "Block", "next 0 of 2");
    for (const language of ["cs", "en"])
      for (const theme of ["dark", "light"]) {
        await changeLanguage(page, language);
        await page.selectOption("#theme", theme);
        await page.locator(".device details").first().evaluate((element) => { element.open = true; });
        await checkAccess(page, `panel of a CNC872, ${language}, ${theme}`);
      }
    await page.locator(".device details").first().evaluate((element) => { element.open = false; });
    for (const [width, height] of [[390, 844], [640, 512], [1280, 800], [1920, 1080]]) {
      await page.setViewportSize({ width, height });
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      assert.ok(wide <= 0, `at ${width} pixels it is ${wide} pixels too wide`);
      await page.screenshot({ path: `${pictures || folder}/window-cnc872-${width}.png`, fullPage: true });
    }
  },

  // A key that is held is let go whatever happens to the page: nothing moves on.
  async cncheld(page, context) {
    await page.selectOption(".device select[aria-label=Mode]", "manual");
    await hold(page, "Z−", 3); // the mouse leaves it
    await button(page, "START").hover();
    await reads(page, 3, 2, "idle");
    await page.mouse.up();
    await hold(page, "X+", 1); // Stop all
    await stopUnits(page);
    await reads(page, 1, 2, "idle");
    await page.mouse.up();
    await hold(page, "X+", 1); // another window has the focus
    await page.evaluate(() => dispatchEvent(new Event("blur")));
    await reads(page, 1, 2, "idle");
    await page.mouse.up();
    await hold(page, "X+", 1); // another language: the keys are made anew
    await page.evaluate(() => {
      document.getElementById("language").value = "cs";
      document.getElementById("language").onchange();
    });
    await reads(page, 1, 2, "idle");
    await page.mouse.up();
    await changeLanguage(page, "en");
    await button(page, "Y+").click({ button: "right" }); // only the main button presses
    await pressed(page, "Y+", false);
    await hold(page, "X+", 1); // the page is loaded anew
    await page.reload();
    await shows(page, ".axes td", "element.textContent === 'X'");
    await reads(page, 1, 2, "idle");
    await page.mouse.up();
    // The page crashes or its connection is cut: rkmctl window lets go what the page held, and nothing else.
    const other = await openPage(context);
    await shows(other, ".axes td", "element.textContent === 'X'");
    await hold(other, "Y+", 2);
    await hold(page, "X+", 1);
    await reads(other, 1, 2, "manual");
    const crash = await context.newCDPSession(page);
    crash.send("Page.crash").catch(() => {});
    await reads(other, 1, 2, "idle");
    await reads(other, 2, 2, "manual");
    await other.mouse.up();
    await reads(other, 2, 2, "idle");
  },

  // rkmctl window is ended while a key is held: the panel that another window shows.
  async cncend(page) {
    await page.selectOption(".device select[aria-label=Mode]", "manual");
    await hold(page, "X+", 1);
    process.kill(Number(process.env.WINDOW_PID), process.env.WINDOW_SIGNAL ?? "SIGTERM");
    await shows(page, "#status", "element.textContent.includes('is lost')");
  },

  // An NC program: typed, chosen as a file, dropped; what is wrong is shown at its place. Choice of a block.
  async cnctext(page) {
    await shows(page, ".axes td", "element.textContent === 'X'");
    const result = (text) => shows(page, ".program p[role=status]", `element.textContent.includes(${quoted(text)})`);
    await page.fill(".program textarea", "G1 X1 F1000\n(č) Q7\n");
    await button(page, "Load").click();
    await result("program.nc:2:6: error: ");
    const colour = (selector) => page.locator(selector).evaluate((element) => getComputedStyle(element).color);
    await page.selectOption("#theme", "light");
    assert.equal(await colour(".program p[role=status]"), "rgb(163, 18, 15)", "what is wrong is red");
    await button(page, "Show the place").click();
    assert.equal(await page.evaluate(() => getSelection().toString() || document.activeElement.value.slice(
      document.activeElement.selectionStart, document.activeElement.selectionEnd)), "Q");
    writeFileSync(folder + "/slow.nc", "G1 X1 F600\n(slowly)\nX2 F1\nX3 M30\n"); // a minute a block
    await page.locator(".program input[type=file]").setInputFiles(folder + "/slow.nc");
    await shows(page, ".program textarea", "element.value.includes('(slowly)')");
    await button(page, "Load").click();
    await result("slow.nc: 3 blocks are loaded.");
    await line(page, "Block", "next 0 of 3");
    await page.locator(".device details summary").first().click();
    await page.fill(".device input[aria-label=Block]", "1");
    await button(page, "Select block").click();
    await line(page, "Block", "next 1 of 3");
    await page.fill(".device input[aria-label=Block]", "9");
    await button(page, "Select block").click();
    await shows(page, ".device > p[role=status].wrong");
    await button(page, "START").click();
    await line(page, "Block", "move, block 1, line 3, next 2 of 3: X2 F1");
    await button(page, "Load").click(); // a block is under way
    await shows(page, ".program p.wrong");
    await button(page, "RESET").click();
    await line(page, "Block", "idle");
    // A file that is dropped is opened; beside its place nothing happens.
    const drop = (selector) => page.evaluate((at) => {
      const data = new DataTransfer();
      data.items.add(new File(["G0 X0\n"], "home.nc"));
      const event = new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true });
      return document.querySelector(at).dispatchEvent(event);
    }, selector);
    assert.equal(await drop(".axes"), false, "the browser does not open the file");
    assert.equal(await drop(".program textarea"), false);
    await shows(page, ".program textarea", "element.value === 'G0 X0\\n'");
    await shows(page, ".program h3", "element.textContent === 'NC program home.nc'");
    await page.locator(".program textarea").evaluate((area) => {
      area.value = "(x)\n".repeat(70000);
      area.oninput();
    });
    await button(page, "Load").click();
    await result("more than 250000 bytes");
    const [saved] = await Promise.all([page.waitForEvent("download"), button(page, "Save").click()]);
    assert.equal(saved.suggestedFilename(), "home.nc");
    assert.equal(readFileSync(await saved.path(), "utf8").length, 280000);
  },

  // Keys of the hand-wheel panels, displays, mechanisms, a critical error; with a PLC program.
  async cncplc(page) {
    await page.locator(".device details summary").first().click();
    await add(page, "PTLTOC_P2");
    await value(page, "PTLTOC_P2", "0");
    await page.selectOption(".device select[aria-label=Keys]", "P2");
    await page.getByRole("button", { name: "Key 3", exact: true }).hover();
    await page.mouse.down();
    await value(page, "PTLTOC_P2", "8");
    await page.mouse.up();
    await value(page, "PTLTOC_P2", "0");
    await page.getByLabel("keep pressed").check();
    await page.getByRole("button", { name: "Key 0", exact: true }).click();
    await value(page, "PTLTOC_P2", "1");
    await page.getByRole("button", { name: "Key 4", exact: true }).click();
    await value(page, "PTLTOC_P2", "17");
    await page.getByRole("button", { name: "Key 0", exact: true }).click();
    await value(page, "PTLTOC_P2", "16");
    await shows(page, ".display", "element.textContent.startsWith('  Abc')");
    // A mechanism runs while its bit is 1.
    assert.deepEqual(await page.locator(".device .lamp").allTextContents(), ["WAIT"]);
    await add(page, "wait");
    await page.locator("table.cells").getByRole("button", { name: "wait 0", exact: true }).click();
    await shows(page, ".device .lamp.lit", "element.getAttribute('aria-label') === 'WAIT 1'");
    await page.fill(".device input[aria-label='Critical error']", "7");
    await button(page, "Set").click();
    await line(page, "PLC program", "critical error 7");
    await button(page, "Clear").nth(0).click();
    await line(page, "PLC program", "critical error 0");
  },

  // Cells: found by a part of the name, set by a click or a number, marked when they change, kept for the next time.
  async cnccells(page) {
    await value(page, "PO_F", "0");
    await page.fill(".cells input[list]", "limit_f");
    await shows(page, "#cell-names option", "element.value === 'LIMIT_FEED' && element.textContent === 'DWRD rw 8.4.1'");
    await add(page, "LIMIT_FEED, FEED_OVR po_pol WORD.BZH09 FILETIME_INFO QWRD.FILETIME_INFO");
    await value(page, "LIMIT_FEED", "0");
    await page.fill(".cells input[aria-label=LIMIT_FEED]", "1F4h");
    await page.press(".cells input[aria-label=LIMIT_FEED]", "Enter");
    await says(page, "cnc.set: done");
    await page.click(".cells h3");
    await value(page, "LIMIT_FEED", "500");
    await page.fill(".cells input[aria-label=LIMIT_FEED]", "many");
    await page.press(".cells input[aria-label=LIMIT_FEED]", "Enter");
    await shows(page, ".cells input.wrong");
    await page.press(".cells input[aria-label=LIMIT_FEED]", "Escape");
    await value(page, "LIMIT_FEED", "500");
    await page.fill(".cells input[aria-label='WORD.BZH09']", "70000");
    await page.press(".cells input[aria-label='WORD.BZH09']", "Enter");
    await says(page, "from 0 to 65535");
    await page.evaluate(() => { // a mark does not stay
      window.marked = [];
      const mark = ({ target }) => target.classList.contains("changed") && window.marked.push(target.firstChild.textContent);
      const observed = { attributes: true, attributeFilter: ["class"], subtree: true };
      new MutationObserver((changes) => changes.forEach(mark)).observe(document.querySelector("table.cells"), observed);
    });
    await page.locator("table.cells").getByRole("button", { name: "FEED_OVR 0", exact: true }).click();
    await value(page, "FEED_OVR", "1");
    await page.waitForFunction(() => window.marked.includes("FEED_OVR"));
    await page.waitForFunction(() => ![...document.querySelectorAll("table.cells tr.changed")].some((row) =>
      row.firstChild.textContent === "FEED_OVR"));
    const fixed = page.locator("table.cells tr", { hasText: "po_pol" });
    assert.equal(await fixed.locator("td.value > *").count(), 0, "it may only be read");
    await shows(page, ".cells p.wrong", "element.textContent.includes('FILETIME_INFO')");
    assert.equal(await page.inputValue(".cells input[list]"), "FILETIME_INFO", "what is wrong stays to be corrected");
    // A number that a double cannot hold is shown as it is: 100 ns since 1601.
    await shows(page, "table.cells tr", "element.firstChild.textContent.startsWith('QWRD.FILE') && "
      + "/^1259\\d{14}$/.test(element.children[2].textContent)");
    await add(page, "NONSENSE");
    await shows(page, ".cells p.wrong", "element.textContent.includes('NONSENSE')");
    assert.equal(await page.inputValue(".cells input[list]"), "NONSENSE");
    await page.getByRole("button", { name: "Remove QWRD.FILETIME_INFO" }).click();
    await page.reload();
    await value(page, "WORD.BZH09", "0");
    const rows = await page.locator("table.cells tbody th").allTextContents();
    assert.deepEqual(rows, ["PO_F", "PO_STOP", "STOP_REQ", "LIMIT_FEED", "FEED_OVR", "po_pol", "WORD.BZH09"]);
    await checkAccess(page, "cells");
    // Without power there are no cells; they come back with it.
    await page.getByRole("button", { name: "Power", exact: true }).click();
    await shows(page, ".unit.off");
    await page.reload();
    await shows(page, "table.cells td.value", "element.textContent.includes('no power')");
    await page.getByRole("button", { name: "Power", exact: true }).click();
    await value(page, "PO_F", "0");
    await add(page, "PO_POS PO_POL PO_F PO_F");
    assert.equal(await page.locator("table.cells tbody tr").count(), 7, "a name is there once");
  },

  // A bit, a mechanism and a number that are otherwise for one T, between two readings, on a clock that another client advances.
  async cncpulse(page) {
    await shows(page, ".axes td", "element.textContent === 'X'");
    await add(page, "BLIP PEAK COUNT");
    await value(page, "COUNT", "0");
    await value(page, "BLIP", "0");
    await shows(page, ".device .lamp:not(.lit)", "element.textContent === 'SHORT'");
    const row = (name, condition) => `element.firstChild.textContent === ${quoted(name)} && ${condition}`;
    const blip = () => Promise.all([
      shows(page, "table.cells tr.pulsed", row("BLIP", "element.children[2].textContent === '1'")),
      shows(page, "table.cells tr.changed", row("PEAK", "element.children[2].firstChild.value === '0'")),
      shows(page, ".device .lamp.lit", "element.textContent === 'SHORT'"),
      new Promise((done, failed) => execFile(process.env.RKMCTL, ["-c", folder + "/bus.control", "advance", "20ms"],
        (error) => error ? failed(error) : done())),
    ]);
    await blip();
    await shows(page, "table.cells tr:not(.pulsed)", row("BLIP", "element.children[2].textContent === '0'"));
    await shows(page, ".device .lamp:not(.lit)");
    await page.fill(".cells input[aria-label=COUNT]", "0");
    await page.press(".cells input[aria-label=COUNT]", "Enter");
    await page.waitForFunction(() => document.querySelectorAll("table.cells tr.changed").length === 0);
    await add(page, "MPXPI"); // another list of cells
    await value(page, "MPXPI", "1");
    await blip();
  },

  // The text of the PLC program: listed with values and where it waits, edited, refused with its place, loaded by whomever.
  async cncedit(page) {
    const control = (...words) => execFileSync(process.env.RKMCTL, ["-c", folder + "/bus.control", ...words]);
    const listed = (line, shown) => shows(page, `.listing.plc > div:nth-child(${line})`,
      `[...element.children].map((one) => one.textContent).join('|') === ${quoted(shown)}`);
    const lamps = (name) => shows(page, ".device .lamp:only-of-type", `element.textContent === ${quoted(name)}`);
    await lamps("WAIT");
    await page.locator("details.plc summary").click();
    await listed(6, "6|0|  LOD COUNT");
    await listed(13, "13||MODULE_MAIN_END");
    control("cnc", "set", "WAIT=1");
    control("advance", "7ms");
    await listed(6, "6|6|  LOD COUNT");
    await shows(page, ".listing.plc [aria-current=step]", "element.textContent === '11  EX0'");
    await shows(page, ".plc p.note",
      "element.textContent.endsWith('MODULE_MAIN: 7 instructions, at most 7\\nWAIT waits in line 11')");
    await checkAccess(page, "PLC program");
    // Edited: a mistake is shown at its place, and changes nothing.
    await button(page, "Edit what runs").click();
    const area = page.locator(".plc-program textarea");
    assert.equal(await area.inputValue(), readFileSync(folder + "/wait.plc", "utf8").trimEnd());
    await area.fill((await area.inputValue()).replace("EX0", "EXO").replace(/WAIT/g, "PAUSE"));
    const load = page.locator(".plc-program").getByRole("button", { name: "Load", exact: true });
    await load.click();
    await shows(page, ".plc-program p.wrong", "element.textContent.includes('program.plc:11:3: error: ')");
    await page.locator(".plc-program").getByRole("button", { name: "Show the place" }).click();
    assert.equal(await area.evaluate((one) => one.value.slice(one.selectionStart, one.selectionEnd)), "E");
    await lamps("WAIT");
    await area.fill((await area.inputValue()).replace("EXO", "EX0"));
    await load.click();
    await shows(page, ".plc-program p.note", "element.textContent === 'program.plc: 8 instructions are loaded.'");
    await lamps("PAUSE");
    await listed(9, "9|0|MECH_BEGIN PAUSE");
    await listed(6, "6|0|  LOD COUNT");
    // By another client; the cells of the table are those of the new program.
    await add(page, "COUNT PAUSE");
    await value(page, "PAUSE", "0");
    control("cnc", "load", folder + "/other.plc");
    await lamps("OTHER");
    await listed(9, "9|0|MECH_BEGIN OTHER");
    await shows(page, "table.cells tr", "element.firstChild.textContent === 'PAUSE' && /no cell/.test(element.textContent)");
    control("advance", "3ms");
    await value(page, "COUNT", "3");
    for (const [width, height] of [[390, 844], [1280, 800]]) {
      await page.setViewportSize({ width, height });
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      assert.ok(wide <= 0, `at ${width} pixels it is ${wide} pixels too wide`);
      await page.locator("details.plc").scrollIntoViewIfNeeded();
      await page.screenshot({ path: `${pictures || folder}/window-cnc872-plc-${width}.png` });
    }
  },

  // What another client changes is seen soon, although nothing moves and no event comes. The middle one of nine counts, less the
  // time that any answer takes: the machine may be busy.
  async cncnews(page) {
    await shows(page, ".axes td", "element.textContent === 'X'");
    const times = [];
    for (let gear = 2; gear <= 10; gear++) {
      const cells = `cells={"SPINDLE_GEAR_ACT_1": ${gear}}`;
      execFileSync(process.env.RKMCTL, ["-c", folder + "/bus.control", "call", "cnc.set", cells]);
      const begun = performance.now();
      await line(page, "Spindle", `gear ${gear},`);
      const seen = performance.now();
      await roundTrip(page);
      times.push(Math.round(seen - begun - (performance.now() - seen)));
    }
    console.log(`seen after ${times.join(", ")} ms`);
    assert.ok(times.sort((a, b) => a - b)[4] <= 300, `seen after ${times.join(", ")} ms`);
  },

  // A value that does not change for a while is drawn level, up to its change.
  async cnclevel(page) {
    await shows(page, ".axes td", "element.textContent === 'X'");
    const values = await page.evaluate(async () => {
      const { Graph } = await import("./graph.js");
      const graph = new Graph(document.createElement("canvas"), 1, 1), clock = performance.now;
      const add = (real, time, value) => {
        performance.now = () => real;
        graph.add(0, 0, time, value);
      };
      add(0, 1000, 5);
      add(400, 9000, 7);
      add(450, 9050, 8);
      performance.now = clock;
      return graph.parts[0][0].map(({ begin, time, first, last }) => [begin, time, first, last]);
    });
    assert.deepEqual(values, [[1000, 1000, 5, 5], [1000, 8000, 5, 5], [9000, 9050, 7, 8]]);
  },

  // The emulator ends, and comes again with a PLC program: what was typed stays, what it has is shown. A stop that nobody
  // answers is no stop.
  async cncloss(page) {
    const control = folder + "/bus.control";
    await page.fill(".program textarea", "G0 X1\n");
    process.kill(Number(process.env.EMULATOR_PID), "SIGSTOP");
    await page.press("body", "F8");
    await shows(page, "#status", "element.textContent.includes('Stop was not done by units: 1. no answer')");
    process.kill(Number(process.env.EMULATOR_PID), "SIGCONT");
    execFileSync(process.env.RKMCTL, ["-c", control, "shutdown"]);
    await shows(page, "#inside", "element.hidden");
    const again = spawn(process.env.RKM04, ["serve", "--device", "cnc872", "--control", control, "--plc", folder + "/wait.plc"],
      { stdio: "ignore" });
    try {
      await shows(page, "#inside", "!element.hidden");
      await shows(page, ".device .lamp", "element.textContent === 'WAIT'");
      assert.equal(await page.inputValue(".program textarea"), "G0 X1\n");
      await stopUnits(page);
    } finally {
      again.kill();
    }
  },

  // Sixteen axes: those of the configuration, each with its curve; a rotary one in degrees.
  async cncaxes(page) {
    await shows(page, ".axes td", "element.textContent === '16'");
    assert.equal(await page.locator(".axes tbody tr").count(), 16);
    const names = (await page.locator(".curves label").allTextContents()).map((text) => text.trim());
    assert.deepEqual(names, ["X", "Y", "Z", ...Array.from({ length: 13 }, (_, at) => String(at + 4))]);
    await reads(page, 4, 3, "0.000°");
    await page.locator(".curves").scrollIntoViewIfNeeded();
    await page.selectOption(".device select[aria-label=Mode]", "manual");
    await button(page, "16+").focus();
    await page.keyboard.down("Enter");
    await shows(page, ".axes tbody tr:nth-child(16) td:nth-child(3)", "Number(element.textContent) > 2");
    await page.keyboard.up("Enter");
    await reads(page, 16, 2, "idle");
    await page.selectOption("#clock", "stepped"); // the picture stays
    await shows(page, "#steps button", "!element.disabled");
    const picture = () => page.locator(".curves canvas").evaluate((canvas) =>
      new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(canvas.toDataURL())))));
    const box = page.locator(".curves label", { hasText: "16" }).locator("input");
    let all, without, again;
    do { // until the last state has come
      all = await picture();
      await box.uncheck();
      without = await picture();
      await box.check();
      again = await picture();
    } while (again !== all);
    assert.notEqual(without, all);
    // Another theme: the curves have its colours at once.
    const light = await picture();
    await page.selectOption("#theme", "dark");
    assert.notEqual(await picture(), light);
    await page.selectOption("#theme", "auto");
    for (const [width, height] of [[390, 844], [1280, 800], [1920, 1080]]) {
      await page.setViewportSize({ width, height });
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      assert.ok(wide <= 0, `at ${width} pixels it is ${wide} pixels too wide`);
      await page.screenshot({ path: `${pictures || folder}/window-cnc872-axes-${width}.png` });
    }
  },
};
