// The mission viewer in a real browser: ED3R_VIEWER is the folder of `ed3r replay --html --beside`.
import assert from "node:assert/strict";
import { readFileSync, statSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const folder = resolve(process.env.ED3R_VIEWER);
const shots = process.env.ED3R_SHOTS;
const file = join(folder, "mission.html");
const address = pathToFileURL(file).href;
const axe = createRequire(import.meta.url).resolve("axe-core/axe.min.js");
const [head, ...lines] = readFileSync(join(folder, "timesteps.csv"), "utf8").trim().split("\n");
const columns = head.split(",");
const stored = lines.map((line) =>
  Object.fromEntries(line.split(",").map((cell, i) => [columns[i], Number(cell)])),
);

let browser;
before(async () => {
  browser = await chromium.launch({
    executablePath: process.env.ED3R_CHROMIUM,
    args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--use-gl=angle", "--use-angle=swiftshader"],
  });
});
after(() => browser?.close());

async function open(options = {}, fragment = "", at = address) {
  const page = await browser.newPage({ viewport: { width: 1000, height: 700 }, ...options });
  page.faults = [];
  // Of WebGL drivers alone: reading back pixels for a screenshot is slow.
  page.on("console", (message) => message.type() === "error" && page.faults.push(message.text()));
  page.on("pageerror", (error) => page.faults.push(error.message));
  page.on("request", (request) => {
    if (!/^(data|blob):/.test(request.url()) && request.url().split("#")[0] !== at)
      page.faults.push(`asked for ${request.url()}`);
  });
  // Software draws slowly where cores are busy.
  page.setDefaultTimeout(120_000);
  await page.goto(at + fragment, { timeout: 120_000 });
  await page.waitForSelector("html[data-ready]");
  return page;
}

/** To this part of the first mission's timestep: 1 is its end, where the robot stands as the record has it. */
async function scrubTo(page, k, share) {
  const time = await page.evaluate(
    ([k, share]) => {
      const { begin_s: begin, duration_s: duration } = JSON.parse(
        document.getElementById("page-data").textContent,
      ).missions[0].steps;
      const bar = document.querySelector("#controls input");
      bar.value = begin[k - 1] + share * duration[k - 1];
      bar.dispatchEvent(new Event("input"));
      return Number(bar.value);
    },
    [k, share],
  );
  return time;
}

const place = (page) => page.$eval(".panel", (panel) => ({ ...panel.dataset }));

for (const fragment of ["", "#map"])
  test(`the scrub bar moves the robot to the stored pose${fragment && ", seen from above"}`, async () => {
    // Small, as software draws it here.
    const page = await open({ viewport: { width: 700, height: 480 } }, fragment);
    assert.equal(
      await page.$$eval(".view canvas", (list) => list.length > 0),
      fragment === "",
      "WebGL or the map",
    );
    for (const row of [stored[0], stored.at(-1)]) {
      await scrubTo(page, row.k, 0.999);
      const shown = await place(page);
      assert.equal(Number(shown.step), row.k);
      for (const axis of ["x", "y", "z"])
        assert.ok(
          Math.abs(Number(shown[axis]) - row[`${axis}_m`]) < 1e-3,
          `${axis} ${shown[axis]} ${row[`${axis}_m`]}`,
        );
    }
    assert.deepEqual(page.faults, []);
    if (shots) await page.screenshot({ path: join(shots, `viewer${fragment.replace("#", "-")}.png`) });
    await page.close();
  });

test("play moves time on, pause stops it, keys step", async () => {
  const page = await open({}, "#map");
  const time = () => page.$eval("#controls input", (bar) => Number(bar.value));
  await page.click(".play");
  await page.waitForFunction(() => Number(document.querySelector("#controls input").value) > 1);
  await page.click(".play");
  const stopped = await time();
  await page.waitForTimeout(200);
  assert.equal(await time(), stopped);
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("Home");
  await page.keyboard.press("ArrowRight");
  assert.equal(Number((await place(page)).step), Math.min(2, stored.length));
  await page.close();
});

test("results are grey until they are there, and why each mission ended is told from the start", async () => {
  const page = await open({}, "#map");
  const stages = () =>
    page.$eval(".mission:first-child .stages", (node) => [
      node.textContent,
      node.querySelectorAll(".future").length,
    ]);
  const [before, grey] = await stages();
  assert.match(before, /will come out .*will look.*will be: /s);
  assert.ok(grey >= 3, `${grey}`);
  const why = await page.$$eval(".mission .end", (list) => list.map((node) => node.textContent));
  assert.equal(why.length, 2);
  for (const text of why) assert.match(text, /^Ended .*Jump to the (deciding|surest|last) look$/);
  await page.click(".mission:first-child .jump");
  assert.match(await page.textContent(".mission:first-child .now"), /nowsensing/);
  assert.ok((await page.$$("#controls .mark")).length >= 2);
  await page.evaluate(() => {
    const bar = document.querySelector("#controls input");
    bar.value = bar.max;
    bar.dispatchEvent(new Event("input"));
  });
  const ends = await page.$$eval(".mission .now", (list) => list.map((node) => node.textContent));
  assert.equal(ends.length, 2);
  for (const now of ends) assert.match(now, /nowended/);
  const [after, left] = await stages();
  assert.doesNotMatch(after, /will /);
  assert.equal(left, 0);
  assert.deepEqual(page.faults, []);
  await page.close();
});

test("two missions share the page, and no axe fault", async () => {
  const page = await open({ viewport: { width: 1400, height: 1000 }, bypassCSP: true }, "#map");
  assert.equal((await page.$$(".mission")).length, 2);
  await page.addScriptTag({ path: axe });
  const found = await page.evaluate(() =>
    axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21aa", "best-practice"] }),
  );
  assert.deepEqual(
    found.violations.map(
      (fault) => `${fault.impact} ${fault.id}: ${fault.nodes.length} × ${fault.nodes[0].html.slice(0, 140)}`,
    ),
    [],
  );
  await page.close();
});

test("LiDARs tell the nearest surface that is stored, and the decision panel the stored choice", async () => {
  const page = await open({}, "#map");
  const data = await page.evaluate(
    () => JSON.parse(document.getElementById("page-data").textContent).missions[0],
  );
  const at = data.track.t_s.findIndex((t, i) => t > 0 && data.lidar.met.some(([sample]) => sample === i));
  assert.ok(at > 0, "some surface is within range");
  await page.evaluate((time) => {
    const bar = document.querySelector("#controls input");
    bar.value = time;
    bar.dispatchEvent(new Event("input"));
  }, data.track.t_s[at] + 1e-6);
  const from = ["x_m", "y_m", "z_m"].map((axis) => data.track[axis][at]);
  const nearest = Math.min(
    ...data.lidar.met
      .filter(([sample]) => sample === at)
      .map(([, ...point]) => Math.hypot(...from.map((value, i) => point[i] - value))),
  );
  const told = await page.$$eval(".mission:first-child .value", (values) =>
    Object.fromEntries(
      values.map((v) => [v.querySelector("small").textContent, v.querySelector("b").textContent]),
    ),
  );
  assert.equal(Number.parseFloat(told["LiDAR, nearest"]), Number(nearest.toFixed(1)));

  // A timestep whose motion was chosen by predicted reward: the best candidate is the one that was flown.
  const greedy = data.decisions.findIndex((decision) => decision.candidates.length > 0);
  assert.ok(greedy >= 0);
  await scrubTo(page, greedy + 1, 0.5);
  const text = await page.$eval(".mission:first-child .stages", (stages) => stages.textContent);
  const row = stored[greedy];
  const moved = Math.hypot(row.command_dx_m, row.command_dy_m, row.command_dz_m).toFixed(1);
  assert.ok(text.includes(`${data.decisions[greedy].rule}: ${moved} m`), text);
  assert.ok(text.includes(`expected ${row.rc_predicted_reward.toFixed(3).replace("-", "−")}`), text);
  const [dx, dy, dz, reward] = data.decisions[greedy].candidates[0];
  assert.ok(Math.abs(reward - row.rc_predicted_reward) < 1e-3, "the best candidate's reward was expected");
  assert.ok(
    Math.hypot(dx - row.command_dx_m, dy - row.command_dy_m, dz - row.command_dz_m) < 0.1,
    "the best candidate was flown",
  );
  await page.close();
});

test("a mission that looks at pixels shows the frame of its last look", async () => {
  const pixels = pathToFileURL(join(resolve(process.env.ED3R_PIXELS), "mission.html")).href;
  const page = await open({}, "#map", pixels);
  const data = await page.evaluate(
    () => JSON.parse(document.getElementById("page-data").textContent).missions[0],
  );
  assert.equal(data.frames.jpeg.length, data.steps.k.length);
  const shown = () =>
    page.$eval(".camera img", async (image) => {
      if (image.src) await image.decode();
      return [image.hidden, image.src.replace("data:image/jpeg;base64,", ""), image.naturalWidth];
    });
  assert.deepEqual(await shown(), [true, "", 0]);
  for (const k of [1, data.steps.k.length]) {
    await scrubTo(page, k, 0.999);
    assert.deepEqual(await shown(), [false, data.frames.jpeg[k - 1], data.frames.width_px]);
  }
  assert.ok(data.decisions.length === data.steps.k.length, "its agents are asked, too");
  assert.deepEqual(page.faults, []);
  if (shots) await page.screenshot({ path: join(shots, "viewer-pixels.png") });
  await page.close();
});

test("it is small and fits a phone", async () => {
  assert.ok(statSync(file).size < 3e6, `${statSync(file).size} bytes`);
  const page = await open({ viewport: { width: 390, height: 844 } }, "#map");
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  await page.close();
});
