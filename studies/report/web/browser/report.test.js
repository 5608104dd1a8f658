// The report in a real browser: ED3R_REPORT is the folder of a report of sweep.yaml; pictures for people to look at go to
// ED3R_SHOTS.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const folder = resolve(process.env.ED3R_REPORT);
const shots = process.env.ED3R_SHOTS;
const address = pathToFileURL(join(folder, "index.html")).href;
const report = JSON.parse(readFileSync(join(folder, "report.json"), "utf8"));
const axe = createRequire(import.meta.url).resolve("axe-core/axe.min.js");

let browser;
before(async () => {
  // Chromium's own sandbox does not work for root, nor in most containers; the page is ours.
  browser = await chromium.launch({ executablePath: process.env.ED3R_CHROMIUM, args: ["--no-sandbox"] });
});
after(() => browser?.close());

/** A page that remembers whatever it asked for or complained of. */
async function open(options = {}, fragment = "") {
  const page = await browser.newPage({ viewport: { width: 1400, height: 900 }, ...options });
  page.faults = [];
  page.on(
    "console",
    (message) => ["error", "warning"].includes(message.type()) && page.faults.push(message.text()),
  );
  page.on("pageerror", (error) => page.faults.push(error.message));
  page.on("request", (request) => {
    if (!/^(data|blob):/.test(request.url()) && request.url().split("#")[0] !== address)
      page.faults.push(`asked for ${request.url()}`);
  });
  await page.goto(address + fragment);
  await page.waitForSelector("html[data-ready]");
  return page;
}

const arms = (page) => page.$$eval("#headline-table tbody tr", (rows) => rows.map((row) => row.dataset.arm));
const flown = Object.keys(report.arms).filter((arm) => report.arms[arm].stage === "online");

test("opens without a fault and without asking for anything", async () => {
  const page = await open();
  assert.deepEqual(page.faults, []);
  assert.deepEqual(await arms(page), flown);
  await page.close();
});

test("its head names what was not as in the paper", async () => {
  const page = await open();
  const notes = await page.$$eval("#headline .lead .note", (list) => list.map((note) => note.textContent));
  assert.equal(report.paper.claims_judged, true);
  assert.equal(notes.length, 1);
  assert.match(notes[0], /^Unlike the paper, in numbers alone: 12 missions of warmup \(paper 2040\); /);
  await page.close();
});

test("its numbers are those of report.json", async () => {
  const page = await open();
  const shown = await page.$$eval("#headline-table td[data-metric]", (cells) =>
    cells.map((cell) => ({
      arm: cell.parentElement.dataset.arm,
      metric: cell.dataset.metric,
      value: Number(cell.dataset.value),
      text: cell.querySelector("b").textContent,
    })),
  );
  assert.ok(shown.length >= 20, `${shown.length} cells`);
  for (const { arm, metric, value, text } of shown) {
    const { mean } = report.arms[arm][metric];
    assert.equal(value, mean, `${arm} ${metric}`);
    assert.ok(Math.abs(Number(text) - mean) <= 0.05 + 1e-9, `${arm} ${metric}: ${text} for ${mean}`);
  }
  const verdicts = new Map(report.claims.map((claim) => [claim.id, claim.verdict]));
  const rows = await page.$$eval("#claims tbody tr", (list) =>
    list.map((row) => [
      row.children[0].textContent,
      row.lastElementChild.querySelector(".verdict").textContent,
    ]),
  );
  assert.equal(rows.length, report.claims.filter((claim) => claim.verdict !== "not measured").length);
  for (const [id, verdict] of rows)
    assert.equal(verdict.replace(/ \(luck\??\)$|, by construction$/, ""), verdicts.get(id), id);
  await page.close();
});

test("a click on an arm filters plot, table and map at once, and the address tells it", async () => {
  const page = await open();
  const map = () =>
    page.$$eval("#sites .site", (sites) => sites.map((site) => site.getAttribute("aria-label")));
  const before = await map();
  await page.click('#plane .mark[data-arm="rbs"]');
  assert.deepEqual(await arms(page), ["rbs"]);
  assert.equal(await page.$$eval("#plane .mark", (marks) => marks.length), 1);
  assert.equal(await page.$$eval("#site-table thead th", (heads) => heads.length), 2);
  const after = await map();
  assert.equal(after.length, before.length);
  assert.notDeepEqual(after, before);
  assert.match(page.url(), /#arms=rbs$/);
  const again = await open({}, new URL(page.url()).hash);
  assert.deepEqual(await arms(again), ["rbs"]);
  await again.close();
  assert.deepEqual(page.faults, []);
  await page.close();
});

test("a site and an outcome are chosen by keyboard, and numbers follow", async () => {
  const page = await open();
  await page.focus('#sites .site[data-site="0"]');
  await page.keyboard.press("Enter");
  // By the number in its name.
  const name = await page.$eval('#sites .site[data-site="0"]', (site) => site.getAttribute("aria-label"));
  const shown = /(\d+):/.exec(name)?.[1] ?? "0";
  assert.equal(await page.textContent('#sites .site[data-site="0"] text'), shown);
  assert.match(page.url(), new RegExp(`site=${shown}(&|$)`));
  assert.equal(await page.$eval("#filters select", (select) => select.value), "0");
  assert.equal(await page.$$eval("#site-table tbody tr", (rows) => rows.length), 1);
  const missions = await page.$eval('#headline-table tr[data-arm="rbs"] small', (small) =>
    parseInt(small.textContent),
  );
  assert.ok(missions > 0 && missions < report.arms.rbs.missions);
  await page.selectOption("#filters label:nth-of-type(2) select", "1");
  // Among false alarms their share is 100 %: the column says nothing and is left out.
  assert.equal((await page.$$('#headline-table td[data-metric="fp_pct"]')).length, 0);
  assert.ok((await page.$$('#headline-table td[data-metric="total_energy_kj"]')).length > 0);
  assert.match(
    await page.textContent("#headline .note[role=status]"),
    /^Shown below: missions at .* false alarm\./,
  );
  await page.click("#filters .reset");
  assert.deepEqual(await arms(page), flown);
  await page.close();
});

test("tables sort by their headings", async () => {
  const page = await open();
  await page.click("#headline-table th:nth-child(2) button");
  const order = await arms(page);
  const energy = order.map((arm) => report.arms[arm].total_energy_kj.mean);
  assert.deepEqual(
    energy,
    [...energy].sort((a, b) => b - a),
  );
  await page.close();
});

test("claims filter by verdict", async () => {
  const page = await open();
  await page.click("#claims .verdict.chip");
  const wanted = await page.$eval("#claims .chip[aria-pressed=true]", (chip) => chip.dataset.verdict);
  const shown = await page.$$eval("#claims tbody tr", (rows) =>
    rows.map((row) => row.lastElementChild.textContent),
  );
  assert.ok(shown.length > 0 && shown.every((verdict) => verdict.startsWith(wanted)), shown.join());
  await page.close();
});

test("claims are found by their text, those of the abstract first", async () => {
  const page = await open();
  const rows = () =>
    page.$$eval("#claims tbody tr", (list) =>
      list.map((row) => [row.children[0].textContent, row.textContent]),
    );
  const all = await rows();
  const abstract = report.claims.filter(
    (claim) => claim.where === "Abstract" && claim.verdict !== "not measured",
  );
  assert.deepEqual(
    all.slice(0, abstract.length).map(([id]) => id),
    abstract.map((claim) => claim.id),
  );
  await page.fill("#claims input[type=search]", "WER baselines");
  const found = await rows();
  assert.ok(found.length < all.length, `${found.length} of ${all.length}`);
  await page.fill("#claims input[type=search]", all.at(-1)[0]);
  assert.ok((await rows()).some(([id]) => id === all.at(-1)[0]));
  assert.match(page.url(), new RegExp(`find=${all.at(-1)[0]}`));
  assert.deepEqual(page.faults, []);
  await page.close();
});

test("texts that look like markup stay texts", async () => {
  const page = await open();
  assert.equal(await page.evaluate(() => window.hacked), undefined);
  assert.match(await page.textContent("h1"), /<script>window\.hacked = 1<\/script> & "quoting"/);
  assert.match(await page.textContent("#run"), /<script>window\.hacked=2<script>/);
  await page.close();
});

test("failed missions have the command that flies them again", async () => {
  const page = await open();
  await page.click("#failures summary");
  const command = await page.textContent("#failures .commands li code");
  assert.match(command, /^ed3r replay '.*<script>.*' online\/[\w-]+\/\d+ --html$/);
  await page.close();
});

for (const colorScheme of ["light", "dark"])
  test(`axe finds no fault of accessibility, ${colorScheme}`, async () => {
    // One verdict's claims, and of many lists alike the first: axe takes long for long tables.
    const page = await open({ colorScheme, bypassCSP: true }, "#verdict=differs");
    for (const place of ["#plane", "#distributions", "#failures", "#tables"])
      await page.$eval(`${place} details`, (node) => (node.open = true));
    await page.$$eval("#tables details:not(:first-of-type)", (list) =>
      list.forEach((node) => (node.open = false)),
    );
    await page.addScriptTag({ path: axe });
    const found = await page.evaluate(() =>
      axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21aa", "best-practice"] }),
    );
    const faults = found.violations.map(
      (fault) => `${fault.impact} ${fault.id}: ${fault.nodes.length} × ${fault.nodes[0].html.slice(0, 140)}`,
    );
    assert.deepEqual(faults, []);
    await page.close();
  });

for (const [width, height] of [
  [1400, 900],
  [390, 844],
])
  test(`fits a width of ${width}`, async () => {
    for (const colorScheme of ["light", "dark"]) {
      const page = await open({ viewport: { width, height }, colorScheme });
      assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), width);
      if (shots)
        await page.screenshot({ path: join(shots, `report-${width}-${colorScheme}.png`), fullPage: true });
      await page.close();
    }
  });
