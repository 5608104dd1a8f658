import assert from "node:assert/strict";
import { test } from "node:test";
import { makeStore, parseFragment, START, writeFragment } from "../src/lib/state.js";

test("a fragment gives the state that wrote it", () => {
  const state = {
    ...START,
    arms: ["ed3r-75", "online/rbs@x"],
    site: "3",
    outcome: "1",
    verdict: "not decidable",
  };
  assert.deepEqual(parseFragment(`#${writeFragment(state)}`), state);
});

test("the start writes nothing and nothing gives the start", () => {
  assert.equal(writeFragment(START), "");
  assert.deepEqual(parseFragment(""), { ...START });
});

test("what the page does not know is dropped", () => {
  const allowed = { arm: (key) => key === "rbs", site: (site) => site === "1", outcome: () => false };
  const state = parseFragment("#arms=rbs~none&site=99&outcome=1&__proto__=x&more=2", allowed);
  assert.deepEqual(state, { ...START, arms: ["rbs"] });
});

test("the store tells of changes and toggles", () => {
  const seen = [];
  const store = makeStore({ ...START }, (state) => seen.push(state));
  store.toggleArm("rbs");
  store.toggleArm("ecd2r");
  store.toggleArm("rbs");
  store.toggle("site", "4");
  store.toggle("site", "4");
  assert.deepEqual(
    seen.map((state) => state.arms),
    [["rbs"], ["rbs", "ecd2r"], ["ecd2r"], ["ecd2r"], ["ecd2r"]],
  );
  assert.deepEqual(
    seen.map((state) => state.site),
    ["all", "all", "all", "4", "all"],
  );
});
