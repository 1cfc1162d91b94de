// SPDX-License-Identifier: MIT
// pictures.mjs: screenshots compared with references, coarsely: as mean colours of a grid of cells. The references are pictures
// of one pixel a cell; REFERENCES=write makes them anew, to be looked at then.
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import assert from "node:assert/strict";
import { folder, openPanel, port, connect, says, send, shows, write, AXIS } from "./page.mjs";

const CELLS = 96; // across
const DIFFERENT = 20; // of 255, in one of the colours of a cell
const DIFFERENT_MAX = 0.03; // part of the cells: texts that differ, as times and paths do
const references = new URL("./references/", import.meta.url);
const sizes = [["phone", 390, 844], ["desk", 1366, 900], ["4k", 3840, 2160]];

// A picture reduced to cells: its width, height, colours, and as a PNG. Done by the browser, on a page of its own.
async function reduce(context, png, cells) {
  const page = await context.newPage();
  const result = await page.evaluate(async ([data, across]) => {
    const image = new Image();
    image.src = "data:image/png;base64," + data;
    await image.decode();
    const width = across || image.width, height = Math.round(image.height * width / image.width);
    const canvas = Object.assign(document.createElement("canvas"), { width, height });
    const drawing = canvas.getContext("2d");
    drawing.imageSmoothingQuality = "high";
    drawing.drawImage(image, 0, 0, width, height);
    const colours = [...drawing.getImageData(0, 0, width, height).data];
    return { width, height, colours, png: canvas.toDataURL("image/png").split(",")[1] };
  }, [png.toString("base64"), cells]);
  await page.close();
  return result;
}

async function compare(context, name, png) {
  const now = await reduce(context, png, CELLS), file = new URL(name + ".png", references);
  if (process.env.REFERENCES === "write") {
    mkdirSync(references, { recursive: true });
    writeFileSync(file, Buffer.from(now.png, "base64"));
  }
  assert.ok(existsSync(file), `there is no reference ${name}`);
  const wanted = await reduce(context, readFileSync(file), 0);
  assert.deepEqual([now.width, now.height], [wanted.width, wanted.height], `size of ${name}`);
  let different = 0;
  for (let at = 0; at < now.colours.length; at += 4)
    different += [0, 1, 2].some((colour) => Math.abs(now.colours[at + colour] - wanted.colours[at + colour]) > DIFFERENT);
  const part = different / (now.width * now.height);
  console.log(`${name}: ${(part * 100).toFixed(1)} % of the cells differ`);
  if (part > DIFFERENT_MAX)
    writeFileSync(`${process.env.FAILED || folder}/differs-${name}.png`, png);
  assert.ok(part <= DIFFERENT_MAX, `${name} looks different`);
}

export const cases = {
  // Both views at three sizes look as they did. The clock is stepped: all pictures show the same moment.
  async references(page, context) {
    await connect(page);
    await write(page, "{ Drill: down, wait for the part, up }\n\\ C100 S200 V4000 A8000\n"
      + "L20\n    F9000 R\n    T03 W300 C03\n    B9000 R\nE\n");
    await send(page, "2", "ok");
    await openPanel(page);
    writeFileSync(folder + "/axis.yaml", AXIS);
    await page.setInputFiles("#plant-file", folder + "/axis.yaml");
    for (let second = 0; second < 2; second++) {
      const before = await page.textContent("#time");
      await page.getByRole("button", { name: "+1s" }).click();
      await page.waitForFunction((text) => document.getElementById("time").textContent !== text, before);
    }
    await page.click(".programs summary");
    await shows(page, ".listing [aria-current]", "element.textContent === 'R'");
    await page.click("#tab-service");
    await send(page, "6", "(9000;0)");
    await says(page, "status", port);
    for (const [size, width, height] of sizes) {
      await page.setViewportSize({ width, height });
      for (const view of ["service", "panel"]) {
        await page.click("#tab-" + view);
        await page.evaluate(() => new Promise((done) => {
          window.scrollTo(0, 0);
          document.activeElement.blur();
          requestAnimationFrame(() => requestAnimationFrame(done));
        }));
        await compare(context, `${view}-${size}`, await page.screenshot());
      }
    }
  },
};
