// SPDX-License-Identifier: MIT
// looks.mjs: how the page looks, and what it costs.
import { readFileSync, writeFileSync } from "node:fs";
import assert from "node:assert/strict";
import { address, AXIS, changeLanguage, checkAccess, connect, folder, isBusy, openPanel, pictures, says, send, shows,
  write } from "./page.mjs";

// Figures of time count only on a machine that has nothing else to do; they are always printed.
const LOADED_MS = 300, FRAMES = 55;

export const cases = {
  // Both languages have all words; axe-core finds nothing, light and dark; pictures at three sizes.
  async looks(page) {
    await connect(page);
    await send(page, "2", "ok");
    await send(page, "6", "(5000;0)");
    await page.click("#poll");
    for (const language of ["cs", "en"]) {
      await changeLanguage(page, language);
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
    await page.click("#tab-panel");
    await page.click(".programs summary");
    await shows(page, ".listing [aria-current]");
    for (const [size, width, height] of [["phone", 390, 844], ["desk", 1366, 900], ["4k", 3840, 2160]]) {
      await page.setViewportSize({ width, height });
      for (const view of ["service", "panel"]) {
        await page.click("#tab-" + view);
        const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
        assert.ok(wide <= 0, `${view} on ${size} is ${wide} pixels too wide`);
        await page.screenshot({ path: `${pictures || folder}/window-${view}-${size}.png`, fullPage: size !== "4k" });
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
    const modules = await other.evaluate(() => performance.getEntriesByType("resource").map((one) => new URL(one.name).pathname)
      .filter((path) => path.endsWith(".js")));
    const loaded = await other.evaluate(() => [...document.querySelectorAll("link[rel=modulepreload], script")]
      .map((one) => new URL(one.href ?? one.src, document.baseURI).pathname));
    assert.deepEqual([...new Set(modules)].sort(), loaded.sort(), "every module is loaded at once");
    assert.ok(bytes > 20000 && bytes < 200000, `${bytes} bytes`);
  },

  // How long the page takes to load; and until it can be used: connected, its program checked. The best one of up to twenty
  // counts: other work can make a time longer only.
  async load(page, context) {
    const times = [], usable = [];
    for (let round = 0; round < 5 || (round < 20 && Math.min(...times) > LOADED_MS); round++) {
      const other = await context.browser().newPage();
      await other.goto(address);
      await other.waitForFunction(() => document.getElementById("status").textContent !== ""
        && document.querySelectorAll("#colours .c-move").length > 0);
      usable.push(Math.round(await other.evaluate(() => performance.now())));
      times.push(Math.round(await other.evaluate(() => performance.getEntriesByType("navigation")[0].loadEventEnd)));
      await other.context().close();
    }
    console.log(`page loaded after ${times.join(", ")} ms, usable after ${usable.join(", ")} ms`);
    assert.ok(Math.min(...times) <= LOADED_MS || isBusy(), `loaded after ${times.join(", ")} ms`);
  },

  // Memory while time runs a hundred times as fast: of the emulator, the window and the page, it is as much at the end as after a
  // third of the time. WINDOW_MINUTES of virtual time, half an hour.
  async memory(page, context) {
    const minutes = Number(process.env.WINDOW_MINUTES || 30), probe = await context.newCDPSession(page);
    const resident = (pid) => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, "utf8"))[1]);
    const sample = async () => {
      await probe.send("HeapProfiler.collectGarbage");
      const heap = Math.round((await probe.send("Runtime.getHeapUsage")).usedSize / 1024);
      return { emulator: resident(process.env.EMULATOR_PID), window: resident(process.env.WINDOW_PID), page: heap };
    };
    const time = async () => parseFloat(await page.textContent("#time"));
    await openPanel(page);
    await page.click(".programs summary");
    const begun = await time();
    let third = null;
    for (;;) {
      const done = (await time() - begun) / 60;
      if (!third && done >= minutes / 3)
        third = await sample();
      if (done >= minutes)
        break;
      await new Promise((resume) => setTimeout(resume, 200));
    }
    const end = await sample();
    console.log(`${minutes} min: after a third ${JSON.stringify(third)} KiB, at the end ${JSON.stringify(end)} KiB`);
    for (const [what, most] of Object.entries(third))
      assert.ok(end[what] <= most * 1.1 + 512, `${what}: ${most} KiB, then ${end[what]} KiB`);
  },

  // Frames a second while sixteen units with four moving motors each are shown. The best of up to four times 5 s counts.
  async frames(page) {
    await openPanel(page);
    await shows(page, ".unit:nth-of-type(16) td", "element.textContent === 'moving'");
    const counts = [];
    while (counts.length === 0 || (counts.length < 4 && Math.max(...counts) < FRAMES)) {
      const frames = await page.evaluate(() => new Promise((done) => {
        const times = [];
        const take = (time) => {
          times.push(time);
          time < times[0] + 5000 ? requestAnimationFrame(take) : done(times);
        };
        requestAnimationFrame(take);
      }));
      const gaps = frames.slice(1).map((time, at) => time - frames[at]).sort((a, b) => a - b);
      const at = (part) => gaps[Math.floor(part * (gaps.length - 1))].toFixed(1);
      counts.push(gaps.length / 5);
      console.log(`${counts.at(-1).toFixed(1)} frames/s, half within ${at(0.5)} ms, 95 % within ${at(0.95)} ms`);
    }
    assert.ok(Math.max(...counts) >= FRAMES || isBusy(), `${counts.join(", ")} frames/s`);
  },
};
