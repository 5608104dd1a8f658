import assert from "node:assert/strict";
import { test } from "node:test";
import { abstractFirst, filterClaims, inWords, saying } from "../src/report/claims.js";
import { groupsOf, partWords, whyShort } from "../src/report/failures.js";
import { logTicks } from "../src/lib/chart.js";
import { fromEnough, roundDown, roundUp } from "../src/report/convergence.js";
import { fullestShare } from "../src/report/distributions.js";
import { barLength } from "../src/report/sites.js";
import { makeModel } from "../src/report/model.js";
import { columnsFor, newsOf, selectionWords, told } from "../src/report/headline.js";
import { caption, title, touch, undominated } from "../src/report/plane.js";

// Two arms, two sites, two metrics; the first site is known.
const data = {
  run: { dir: "results/runs/x y" },
  metrics: [
    { name: "total_energy_kj", decimals: 2 },
    { name: "msr_pct", decimals: 2 },
  ],
  arms: [
    { key: "rbs", name: "rbs", stored_name: "online/rbs@base", missions: 4, label: "RBS", warmup: false },
    {
      key: "warmup",
      name: "warmup",
      stored_name: "warmup/warmup",
      missions: 2,
      label: "Warm-up",
      warmup: true,
    },
  ],
  known_sites: [0],
  world: {
    sites: [
      { name: "ridge", x_m: 1, y_m: 2 },
      { name: "valley", x_m: 3, y_m: 4 },
    ],
  },
  slices: {
    "all|all": [
      [4, 10, 9, 11, 75, 30, 95],
      [2, 100, null, null, 0, null, null],
    ],
    "0|all": [
      [3, 9, 8, 10, 66.6667, 20, 90],
      [2, 100, null, null, 0, null, null],
    ],
    "1|all": [[1, 13, null, null, 100, null, null], null],
  },
  histograms: {
    scales: [{ column: "energy_kj", from: 0, step: 5, bins: 4 }],
    cells: [
      [0, 0, 0, 0, 1, 2],
      [0, 0, 1, 0, 2, 1],
      [0, 1, 0, 0, 2, 1],
      [1, 0, 2, 0, 3, 2],
    ],
  },
  failures: [
    {
      arm: 0,
      cause: "false alarm",
      outcome: 1,
      count: 3,
      known: 2,
      sites: { 0: 2, 1: 1 },
      missions: [
        [2, 0, 9, 1, 7, 2],
        [3, 1, 9, 1, 8, 3],
      ],
    },
    {
      arm: 1,
      cause: "battery empty",
      outcome: 2,
      count: 2,
      known: 2,
      sites: { 0: 2 },
      missions: [[0, 0, 100, 17, 80, 0]],
    },
  ],
};
const model = makeModel(data);
const all = { arms: [], site: "all", outcome: "all" };

test("values of a filter are those of the engine", () => {
  assert.deepEqual(model.cell(model.arms[0], "msr_pct", { site: "0", outcome: "all" }), {
    value: 66.6667,
    lo: 20,
    hi: 90,
    missions: 3,
  });
  assert.equal(model.cell(model.arms[1], "msr_pct", { site: "1", outcome: "all" }), null);
});

test("warm-ups are shown where they are chosen", () => {
  assert.deepEqual(
    model.chosen(all).map((arm) => arm.key),
    ["rbs"],
  );
  assert.deepEqual(
    model.chosen({ ...all, arms: ["warmup"] }).map((arm) => arm.key),
    ["warmup"],
  );
});

test("histograms add up the cells of a filter", () => {
  const counts = (filter) => model.histogram(model.arms[0], "energy_kj", { ...all, ...filter }).counts;
  assert.deepEqual(counts({}), [
    [0, 2, 1, 0],
    [0, 0, 1, 0],
    [0, 0, 0, 0],
  ]);
  assert.deepEqual(counts({ site: "unseen" }), [
    [0, 0, 1, 0],
    [0, 0, 0, 0],
    [0, 0, 0, 0],
  ]);
  assert.deepEqual(counts({ outcome: "1" })[0], [0, 0, 0, 0]);
});

test("pooled success counts missions", () => {
  const both = model.pooled(model.arms, 0);
  assert.equal(both.missions, 5);
  assert.equal(both.success, 2);
});

test("sites have the number of their name in addresses", () => {
  const numbered = makeModel({
    ...data,
    world: { sites: [{ name: "site 1" }, { name: "site 2" }] },
  });
  assert.equal(numbered.siteToAddress("0"), "1");
  assert.equal(numbered.siteFromAddress("1"), "0");
  assert.equal(numbered.siteToAddress("known"), "known");
  assert.equal(numbered.siteFromAddress("all"), "all");
  assert.equal(model.siteToAddress("1"), "1", "no number in its name");
  assert.equal(model.siteFromAddress("1"), "1");
});

test("a map's bar is a round length", () => {
  assert.deepEqual([530, 1000, 260, 90].map(barLength), [100, 200, 50, 10]);
});

test("commands name the arm as the store does", () => {
  assert.equal(model.command(model.arms[0], 7), "ed3r replay 'results/runs/x y' online/rbs@base/7 --html");
});

test("failed missions are grouped by cause within the selection", () => {
  assert.deepEqual(
    groupsOf(model, all).map(({ cause, count }) => [cause, count]),
    [["false alarm", 3]],
  );
  assert.deepEqual(groupsOf(model, { ...all, outcome: "2" }), []);
});

test("failures of a site are counted by the engine, not in the list that is shown", () => {
  const at = (site) => groupsOf(model, { ...all, site })[0];
  assert.equal(at("0").count, 2);
  assert.equal(at("1").count, 1);
  assert.equal(at("known").count, 2);
  assert.equal(at("unseen").count, 1);
  assert.equal(at("all").count, 3);
  assert.equal(at("0").arms[0].of, 3, "missions of the arm at that site");
  assert.equal(partWords(at("0").arms[0], "0"), "2 of 3 missions at this site, one of them listed");
  assert.equal(partWords(at("all").arms[0], "all"), "3 of 4 missions, 2 of them listed");
  assert.equal(partWords({ count: 2, of: 9, missions: [1, 2] }, "known"), "2 of 9 missions at known sites");
  assert.equal(groupsOf(model, { ...all, arms: ["warmup"], site: "1" }).length, 0);
});

test("a failed mission says why in short", () => {
  assert.equal(whyShort(1, 7, 2), "sure of a fire after 7 looks, 2 above the threshold");
  assert.equal(whyShort(2, 83, 0), "83 looks, none above the threshold");
  assert.equal(whyShort(2, 83, 3), "83 looks, 3 above the threshold, never enough in a row");
});

test("an outcome leaves out the columns that it fixes, and the page says what is shown", () => {
  assert.ok(columnsFor(all).includes("fp_pct"));
  assert.deepEqual(columnsFor({ outcome: "1" }), ["total_energy_kj", "duration_mean_min", "mscs_pct"]);
  assert.match(
    selectionWords(model, { site: "1", outcome: "all" }),
    /^Shown below: missions at valley\. .*all missions\.$/,
  );
  assert.match(
    selectionWords(model, { site: "all", outcome: "1" }),
    /missions that ended in: false alarm\. .*MSR, FP, BD, WER/,
  );
  assert.equal(title({ outcome: "1" }), "Energy against false alarms");
  assert.equal(title({ outcome: "0" }), "Energy against success");
});

test("the paper's values stand beside ours where the paper flew the arm, and claims were judged", () => {
  const paper = { msr_pct: { value: 97.18, text: "97.18", within: false } };
  const withClaims = (list) =>
    makeModel({ ...data, studied: 0, claims: { list }, arms: [{ ...data.arms[0], paper }, data.arms[1]] });
  assert.deepEqual(newsOf(withClaims([])), []);
  const [only, ...more] = newsOf(withClaims([{}]));
  assert.equal(more.length, 0);
  assert.equal(only.cell.value, 75);
  assert.equal(only.paper.text, "97.18");
});

test("claims pass filters by verdict, arm, metric and certainty", () => {
  const list = [
    { arms: "ed3r-75 rbs-p85", metric: "msr_pct", verdict: "differs", p: 0.2, p_against: 0.0001 },
    { arms: "ecd2r", metric: "total_energy_kj", verdict: "reproduced", p: 0.04, p_against: 1 },
    { arms: "ecd2r", metric: "total_energy_kj", verdict: "equivalent", p: null, p_against: null },
  ];
  const pass = (filter, names = []) =>
    filterClaims(list, { verdict: "all", about: "all", sure: "all", ...filter }, names).map((claim) =>
      list.indexOf(claim),
    );
  assert.deepEqual(pass({}), [0, 1, 2]);
  assert.deepEqual(pass({ verdict: "differs" }), [0]);
  assert.deepEqual(pass({}, ["rbs"]), [0]);
  assert.deepEqual(pass({ about: "total_energy_kj" }), [1, 2]);
  assert.deepEqual(pass({ sure: "p05" }), [0, 1]);
  assert.deepEqual(pass({ sure: "p001" }), [0]);
  assert.deepEqual(pass({ sure: "none" }), [2]);
});

test("claims are found by every word, in any of what they tell", () => {
  const list = [
    { id: "C001", arms: "rbs", words: "up to 36.4% less", claim: "100*(1 - a / b)", where: "Abstract" },
    { id: "C002", arms: "rbs", words: "RBS fails", claim: "msr: rbs < ecd2r", where: "Result 3" },
  ];
  const every = { verdict: "all", about: "all", sure: "all" };
  const ids = (find) => filterClaims(list, { ...every, find }, []).map((claim) => claim.id);
  assert.deepEqual(ids("rbs FAILS"), ["C002"]);
  assert.deepEqual(ids("c001"), ["C001"]);
  assert.deepEqual(ids("less rbs"), []);
  assert.deepEqual(ids(""), ["C001", "C002"]);
  assert.deepEqual(
    abstractFirst([...list].reverse()).map((claim) => claim.id),
    ["C001", "C002"],
  );
  assert.equal(saying(list[0]).main, "“up to 36.4% less”");
  assert.equal(saying(list[1]).main, "msr: rbs < ecd2r");
});

test("claims speak of arms and metrics as the tables do", () => {
  const words = (text, metric) =>
    inWords(
      text,
      { metric },
      {
        arms: [
          { name: "ed3r-75", label: "ED³R-75" },
          { name: "rbs", label: "RBS" },
          { name: "ed3r", label: "mine" },
        ],
        byName: { msr_pct: { heading: "MSR, %" }, total_energy_kj: { heading: "energy, kJ" } },
      },
    );
  assert.equal(words("msr: ed3r-75 > ablation-1..4", "msr_pct"), "MSR (%): ED³R-75 > Ablations 1 to 4");
  assert.equal(
    words("total energy: 100*(1 - ed3r-p85 / rbs-p85)", "total_energy_kj"),
    "energy (kJ): 100*(1 − P85 of ED³R-75 / P85 of RBS)",
  );
  assert.equal(words("ours - paper = -0.696 (-49 %)", "bd_pct"), "ours − paper = −0.696 (−49 %)");
  assert.equal(words("rc-rfnn input features", "input_features"), "the controller's network input features");
});

test("missions to train on are not counted as judged", () => {
  const arm = (warmup, missions) => ({ warmup, missions, networks: 3 });
  assert.equal(
    told({ arms: [arm(true, 1200), arm(false, 40), arm(false, 2)] }),
    "42 missions judged, 1,200 to train on, 3 trained networks of each kind",
  );
  assert.equal(told({ arms: [{ missions: 1, networks: 1 }] }), "1 mission judged");
});

test("a caption tells of the dashed line and the diamonds where there are any", () => {
  const point = (energy, success, paper = null) => ({ x: { value: energy }, y: { value: success }, paper });
  const best = [point(1, 90), point(2, 80)];
  assert.equal(undominated(best).length, 1);
  assert.doesNotMatch(caption(best, { outcome: "all" }), /dashed|diamond|dotted/);
  assert.match(caption([point(1, 80, {}), point(2, 90)], { outcome: "all" }), /dashed.*diamond.*dotted/);
  assert.doesNotMatch(caption([point(1, 80), point(2, 90)], { outcome: "1" }), /dashed|better/);
});

test("curves begin where there are missions enough, axes at round numbers", () => {
  const at = (...ns) => ns.map((n) => ({ n }));
  assert.deepEqual(fromEnough(at(50, 100, 200)), at(100, 200));
  assert.deepEqual(fromEnough(at(20, 50, 100)), at(20, 50, 100));
  assert.deepEqual([0.29, 1, 4.9, 60].map(roundDown), [0.2, 1, 2, 50]);
  assert.deepEqual([0.29, 1, 5.1, 60].map(roundUp), [0.5, 1, 10, 100]);
});

test("ticks are 1, 2, 5 and the ends", () => {
  const scale = Object.assign((value) => 100 * Math.log10(value), { domain: () => [100, 560] });
  assert.deepEqual(logTicks(scale, 20), [100, 200, 560]);
  assert.deepEqual(logTicks(scale, 2), [100, 200, 500, 560]);
});

test("rows of a distribution share one scale, in shares of their missions", () => {
  const row = (...counts) => ({ counts });
  assert.equal(fullestShare([row([1, 3], [0, 0], [0, 0]), row([0, 1], [0, 1], [8, 0])]), 0.8);
  assert.equal(fullestShare([row([0], [0], [0])]), 1);
});

test("boxes touch where they share ground", () => {
  const box = (x, y) => ({ x, y, width: 10, height: 10 });
  assert.ok(touch(box(0, 0), box(9, 9)));
  assert.ok(!touch(box(0, 0), box(10, 0)));
});
