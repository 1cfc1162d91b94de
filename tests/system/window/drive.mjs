// SPDX-License-Identifier: MIT
// drive.mjs CASE ADDRESS FOLDER [PICTURES]: the window in headless Chromium. NODE_PATH names playwright-core and axe-core.
import assert from "node:assert/strict";
import { chromium, folder, name, openPage, troubles } from "./page.mjs";
import * as cnc from "./cnc.mjs";
import * as devices from "./devices.mjs";
import * as looks from "./looks.mjs";
import * as panel from "./panel.mjs";
import * as pictures from "./pictures.mjs";
import * as service from "./service.mjs";

const cases = { ...service.cases, ...cnc.cases, ...devices.cases, ...panel.cases, ...looks.cases, ...pictures.cases };
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM || "/usr/bin/chromium", args: ["--no-sandbox"] });
let page;
try {
  const viewport = { width: 1366, height: 900 };
  const bypassCSP = ["cib", "looks", "pmc"].includes(name) || name.startsWith("cnc");
  const context = await browser.newContext({ viewport, locale: "en-GB", bypassCSP });
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
