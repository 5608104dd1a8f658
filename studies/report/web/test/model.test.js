import assert from "node:assert/strict";
import { test } from "node:test";
import { filterClaims } from "../src/report/claims.js";
import { groupsOf } from "../src/report/failures.js";
import { makeModel } from "../src/report/model.js";
import { touch } from "../src/report/plane.js";

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
      count: 5,
      missions: [
        [2, 0, 9, 1],
        [3, 1, 9, 1],
      ],
    },
    { arm: 1, cause: "battery empty", outcome: 2, count: 2, missions: [[0, 0, 100, 17]] },
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

test("commands name the arm as the store does", () => {
  assert.equal(model.command(model.arms[0], 7), "ed3r replay 'results/runs/x y' online/rbs@base/7 --html");
});

test("failed missions are grouped by cause within the selection", () => {
  assert.deepEqual(
    groupsOf(model, all).map(({ cause, count }) => [cause, count]),
    [["false alarm", 5]],
  );
  assert.deepEqual(
    groupsOf(model, { ...all, site: "1" }).map(({ count }) => count),
    [1],
  );
  assert.deepEqual(groupsOf(model, { ...all, outcome: "2" }), []);
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

test("boxes touch where they share ground", () => {
  const box = (x, y) => ({ x, y, width: 10, height: 10 });
  assert.ok(touch(box(0, 0), box(9, 9)));
  assert.ok(!touch(box(0, 0), box(10, 0)));
});
