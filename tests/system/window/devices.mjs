// SPDX-License-Identifier: MIT
// devices.mjs: panels of other devices than the RKM04.
import { readFileSync, writeFileSync } from "node:fs";
import assert from "node:assert/strict";
import { changeLanguage, checkAccess, folder, openPanel, pictures, shows, stopUnits } from "./page.mjs";

const cell = (page, row, column) => page.locator(`.device table tbody tr:nth-child(${row}) td:nth-child(${column})`);
const reads = (page, row, column, text) => shows(page, `.device table tbody tr:nth-child(${row}) td:nth-child(${column})`,
  `element.textContent === ${JSON.stringify(text)}`);
const button = (page, name) => page.locator(".device").first().getByRole("button", { name, exact: true });
const says = (page, text) => shows(page, ".device p[role=status]", `element.textContent.includes(${JSON.stringify(text)})`);

export const cases = {
  // All that the maker's window does: manual moves of three kinds, speeds, home search, program, parameters, files, positions.
  async pmc(page) {
    await openPanel(page);
    await shows(page, ".device .note", "element.textContent.startsWith('Face ascii, 9600 baud')");
    // Continuous: until it is stopped.
    await page.fill(".device input[aria-label='Speed X']", "100");
    await page.press(".device input[aria-label='Speed X']", "Enter");
    await button(page, "X+").click();
    await reads(page, 1, 2, "manual");
    await shows(page, ".device tbody tr:first-child td:nth-child(3)", "Number(element.textContent) > 100");
    await button(page, "Stop").click();
    await reads(page, 1, 2, "idle");
    await button(page, "Y−").click();
    await reads(page, 2, 2, "manual");
    await stopUnits(page);
    await reads(page, 2, 2, "idle");
    await page.selectOption(".device select[aria-label='Axis']", "Y");
    await button(page, "Clear counters").click();
    await reads(page, 2, 3, "0");
    // Absolute and relative.
    await page.selectOption(".device select[aria-label='Manual mode']", "absolute");
    assert.equal(await button(page, "X+").isVisible(), false);
    await page.fill(".device input[aria-label='Position X']", "50");
    await button(page, "V3").first().click();
    await shows(page, ".device input[aria-label='Speed X']", "element.value === '1000'");
    await button(page, "Move X").click();
    await reads(page, 1, 3, "50");
    await page.selectOption(".device select[aria-label='Manual mode']", "relative");
    await page.fill(".device input[aria-label='Position Y']", "-7");
    await button(page, "Move Y").click();
    await reads(page, 2, 3, "-7");
    // A value out of range is refused with what was expected.
    await page.fill(".device input[aria-label='Speed X']", "9000");
    await page.press(".device input[aria-label='Speed X']", "Enter");
    await says(page, "8000");
    // The present position becomes a register; the program is read, changed, written, run, stored.
    await page.selectOption(".device select[aria-label='Axis']", "X");
    await page.fill(".device input[aria-label='REG']", "5");
    await button(page, "Register position").click();
    await says(page, "pmc.register_position: done");
    const program = page.locator(".device section.program");
    await program.getByRole("button", { name: "Read" }).click();
    await shows(page, ".device section.program textarea", "element.value.includes('X: 05 ABS 50 V1')");
    await program.locator("textarea").fill("X: 00 INC 20 V2\nX: 01 TIM 60000\nX: 02 END\n");
    await program.getByRole("button", { name: "Write" }).click();
    await says(page, "pmc.program: done");
    await button(page, "Store in memory").first().click();
    await says(page, "pmc.store: done");
    await page.fill(".device input[aria-label='REG']", "0");
    await button(page, "Run program").click();
    await reads(page, 1, 2, "program");
    await reads(page, 1, 3, "70");
    await shows(page, ".device tbody tr:first-child td:nth-child(7)", "element.textContent.startsWith('01 TIM')");
    await button(page, "End program").click();
    await reads(page, 1, 2, "idle");
    await program.locator("textarea").fill("X: 64 NOP\n");
    await program.getByRole("button", { name: "Write" }).click();
    await says(page, "text:");
    // Files.
    writeFileSync(folder + "/new.pmc", "X: 00 END\n");
    await program.locator("input[type=file]").setInputFiles(folder + "/new.pmc");
    await shows(page, ".device section.program textarea", "element.value === 'X: 00 END\\n'");
    const [saved] = await Promise.all([page.waitForEvent("download"), program.getByRole("button", { name: "Save" }).click()]);
    assert.equal(readFileSync(await saved.path(), "utf8"), "X: 00 END\n");
    const parameters = page.locator(".device section.parameters");
    await parameters.getByRole("button", { name: "Read" }).click();
    await shows(page, ".device section.parameters textarea", "/speed4 = 8000/.test(element.value)");
    // What was stored is there after a reset; counters begin anew.
    await button(page, "Reset (RST)").click();
    await reads(page, 1, 3, "0");
    await program.getByRole("button", { name: "Read" }).click();
    await shows(page, ".device section.program textarea", "element.value.includes('X: 01 TIM 60000')");
    // An emergency input, an error that is shown and cleared.
    await page.locator(".unit").first().getByRole("button", { name: "emg", exact: true }).click();
    await reads(page, 1, 9, "emg");
    await page.locator(".unit").first().getByRole("button", { name: "emg", exact: true }).click();
    await page.selectOption(".device select[aria-label='Axis']", "XY");
    await button(page, "Clear errors").click();
    await reads(page, 1, 9, "–");
    await button(page, "Home search").click();
    await reads(page, 2, 2, "search");
    await button(page, "Stop at once").click();
    await reads(page, 2, 2, "idle");
    // A fault holds an input that has a name; a switch of a plant has it, too.
    await page.selectOption("#fault select[name=kind]", "input");
    await page.selectOption("#fault select[name=input]", "y.near");
    await page.press("#fault input[name=count]", "Enter");
    await shows(page, ".unit button[aria-pressed=true]", "element.textContent === 'y.near'");
    writeFileSync(folder + "/near.yaml", "motors:\n  1: {stops: {low: -5000}}\nswitches:\n"
      + "  - {input: x.near, motor: 1, at_most: -9}\n");
    await page.setInputFiles("#plant-file", folder + "/near.yaml");
    await shows(page, ".axis svg text", "element.textContent === 'x.near'");
    for (const language of ["cs", "en"]) {
      await changeLanguage(page, language);
      await checkAccess(page, `panel of a PMC, ${language}`);
    }
    assert.equal(await cell(page, 1, 1).textContent(), "X");
    await page.screenshot({ path: `${pictures || folder}/window-pmc.png` });
  },

  // Drives with their phases and commands, outputs, PWM, inputs, configuration.
  async cib(page) {
    await openPanel(page);
    await reads(page, 1, 1, "A");
    const send = async (drive, command, p1, p2) => {
      await page.selectOption(".device select[aria-label=Drive]", drive);
      await page.selectOption(".device select[aria-label=Command]", String(command));
      await page.fill(".device input[aria-label=P1]", String(p1));
      await page.fill(".device input[aria-label=P2]", String(p2));
      await button(page, "Send").click();
    };
    await send("A", 102, 30, 100);
    await reads(page, 1, 4, "30");
    await reads(page, 1, 3, "idle");
    // 30 pulses of four rows: the second row, 0110, stays on. TRG is told.
    await reads(page, 1, 6, "2");
    await shows(page, ".device tbody tr:first-child .lamp.lit", "element.getAttribute('aria-label') === 'TRG 1'");
    const lit = await page.locator(".device tbody tr:first-child td:last-child .lamp.lit").allTextContents();
    assert.deepEqual(lit, ["DO2", "DO3"]);
    await send("B", 105, -200, 0);
    await reads(page, 2, 3, "moving");
    await shows(page, ".device tbody tr:nth-child(2) .lamp.lit", "element.getAttribute('aria-label') === 'DIR 1'");
    await button(page, "Stop B").click();
    await reads(page, 2, 3, "idle");
    await send("B", 105, 300, 0);
    await reads(page, 2, 3, "moving");
    await stopUnits(page);
    await reads(page, 2, 3, "idle");
    await send("A", 101, 5, 1);
    await reads(page, 1, 7, "3"); // MCERR 3: a speed below 5
    // Another configuration: outputs in place of drives.
    await button(page, "Read").click();
    await shows(page, ".device textarea", "element.value.includes('drive_a')");
    const setup = JSON.parse(await page.inputValue(".device textarea"));
    setup["do1-2"].use = "do";
    setup["do3-4"].use = "pwm";
    setup["do3-4"].period = 100;
    await page.fill(".device textarea", JSON.stringify(setup));
    await button(page, "Write").click();
    await shows(page, ".device section .note", "element.textContent === 'Written, but not applied yet.'");
    await button(page, "Apply").click();
    await shows(page, ".device section .note", "element.textContent === 'This configuration counts.'");
    await reads(page, 1, 2, "false");
    await button(page, "DO1").click();
    await shows(page, ".device button[aria-pressed=true]", "element.textContent === 'DO1'");
    await shows(page, ".front .lamp.lit", "element.textContent === 'do1'");
    await page.locator(".device input[aria-label='PWM 3']").fill("2500");
    await shows(page, ".device .duties output", "element.textContent === '25.00 %'");
    await page.fill(".device textarea", "{");
    await button(page, "Write").click();
    await shows(page, ".device p[role=status].wrong");
    await page.locator(".unit").first().getByRole("button", { name: "di4", exact: true }).click();
    await shows(page, ".unit button[aria-pressed=true]", "element.textContent === 'di4'");
    for (const language of ["cs", "en"]) {
      await changeLanguage(page, language);
      await checkAccess(page, `panel of a CIB module, ${language}`);
    }
    await page.screenshot({ path: `${pictures || folder}/window-cib.png`, fullPage: true });
  },
};
