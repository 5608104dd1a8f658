import assert from "node:assert/strict";
import { test } from "node:test";
import { interval, number, pValue, withInterval } from "../src/lib/format.js";
import { armColours, shareColour } from "../src/lib/palette.js";
import { order } from "../src/lib/table.js";
import { quoted } from "../src/report/model.js";

test("numbers are printed as the text tables do", () => {
  assert.equal(number(10.6571, 2), "10.66");
  assert.equal(number(137.382, 2), "137.4");
  assert.equal(number(0.0253, 3), "0.025");
  assert.equal(number(-1.5, 1), "−1.5");
  assert.equal(number(null), "–");
  assert.equal(number(12345.6, 2), "12,346");
  assert.equal(number(-1234567, 2), "−1,234,567");
});

test("an interval is none where an end is", () => {
  assert.equal(interval(-3.65, -0.05, 2), "−3.65 to −0.05");
  assert.equal(interval(8.126, 13.19, 2), "8.13–13.19");
  assert.equal(interval(null, 1, 2), "");
  assert.equal(withInterval({ value: 1, lo: null, hi: null }, { decimals: 1, unit: "kJ" }), "1.0 kJ");
  assert.equal(withInterval(null, { decimals: 1, unit: "kJ" }), "none");
});

test("small p values keep their digits", () => {
  assert.deepEqual(
    [pValue(0.00001), pValue(0.0042), pValue(0.2), pValue(null)],
    ["<0.0001", "0.0042", "0.200", ""],
  );
});

test("none sorts last, numbers by size", () => {
  assert.deepEqual([3, null, 1, undefined, 10].sort(order).slice(0, 3), [1, 3, 10]);
  assert.deepEqual(["C10", "C9"].sort(order), ["C9", "C10"]);
});

test("words of a command are quoted for a shell", () => {
  assert.equal(quoted("results/runs/a"), "results/runs/a");
  assert.equal(quoted("a b'c"), `'a b'\\''c'`);
});

test("arms of the paper keep their colours, others differ", () => {
  const [ours, first, second] = armColours(["rbs", "light", "heavy"]);
  assert.deepEqual(ours, armColours(["x", "rbs"])[1]);
  assert.notDeepEqual(first, second);
});

test("letters on a share's colour are readable", () => {
  const light = (colour) => {
    const parts = colour.startsWith("#")
      ? [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16))
      : colour.match(/\d+/g).map(Number);
    const [r, g, b] = parts.map((part) =>
      part / 255 <= 0.03928 ? part / 255 / 12.92 : ((part / 255 + 0.055) / 1.055) ** 2.4,
    );
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  for (let share = 0; share <= 1; share += 0.02) {
    const { fill, ink } = shareColour(share);
    const [a, b] = [light(fill), light(ink)].sort((x, y) => y - x);
    assert.ok((a + 0.05) / (b + 0.05) >= 4.5, `${share}: ${fill} ${ink} ${(a + 0.05) / (b + 0.05)}`);
  }
});
