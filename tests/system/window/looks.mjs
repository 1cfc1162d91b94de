// SPDX-License-Identifier: MIT
// looks.mjs: how the page looks, and what it costs.
import { writeFileSync } from "node:fs";
import assert from "node:assert/strict";
import { address, AXIS, checkAccess, connect, folder, openPanel, pictures, says, send, shows, write } from "./page.mjs";

export const cases = {
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
    writeFileSync(folder + "/axis.yaml", AXIS);
    await page.setInputFiles("#plant-file", folder + "/axis.yaml");
    await shows(page, ".axis input[type=range]");
    await checkAccess(page, "panel with an axis");
    await page.click("#tab-service");
    await write(page, "{ Drill: down, wait for the part, up }\n\\ C100 S200 V4000 A8000\n"
      + "L20\n    F9000 R\n    T03 W300 C03\n    B9000 R\nE\n");
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
