import assert from "node:assert/strict";
import { test } from "node:test";
import { makeClock } from "../src/viewer/clock.js";
import { decidingLooks, endOf, makeMission, misleader, misled } from "../src/viewer/mission.js";
import { rewardRange } from "../src/viewer/panel.js";
import { energySoFar } from "../src/viewer/timelines.js";

// Two timesteps of 10 s: 4 s of flight, 3 of sensing, 3 of computing; then 4 of flight, 3 of sensing, 3 of transmitting.
const zero = [0, 0];
const data = {
  duration_s: 20,
  start: [0, 0, 50, 3],
  track: {
    t_s: [1, 3, 11, 13],
    x_m: [0, 10, 10, 30],
    y_m: zero.concat(zero),
    z_m: [50, 50, 50, 60],
    yaw_rad: [3, -3, -3, -3],
  },
  // Of the track's second and third point.
  lidar: {
    range_m: 30,
    safety_m: 2,
    met: [
      [1, 10, 0, 38, 0],
      [1, 15, 0, 50, 1],
      [2, 10, 0, 20.5, 0],
    ],
  },
  battery_j: 10000,
  steps: {
    k: [1, 2],
    begin_s: [0, 10],
    duration_s: [10, 10],
    horizontal_s: [4, 4],
    ascent_s: zero,
    descent_s: zero,
    turning_s: zero,
    sensing_s: [3, 3],
    computing_s: [3, 0],
    transmitting_s: [0, 3],
    x_m: [11, 31],
    y_m: zero,
    z_m: [50, 60],
    yaw_rad: [-3, -3],
    tilt_rad: [0.1, 0.2],
    scs: [0.2, 0.8],
    battery_j: [8470, 5930],
    horizontal_j: [1000, 2000],
    ascent_j: zero,
    descent_j: zero,
    hover_turning_j: zero,
    hover_sensing_j: [500, 500],
    hover_computing_j: zero,
    hover_transmitting_j: zero,
    sensing_j: [10, 10],
    computation_j: [20, 0],
    transmission_j: [0, 30],
  },
};
const mission = makeMission(data);

test("parts of a timestep follow one another", () => {
  assert.deepEqual([1, 5, 8, 11, 15, 18, 20].map(mission.phase), [
    "flying",
    "sensing",
    "computing",
    "flying",
    "sensing",
    "transmitting",
    "ended",
  ]);
  assert.deepEqual([0, 9.99, 10, 25].map(mission.stepAt), [0, 0, 1, 1]);
});

test("the robot flies along its track and stands where the record has it", () => {
  assert.deepEqual(mission.pose(0), { x: 0, y: 0, z: 50, yaw: 3, tilt: 0.1 });
  assert.equal(mission.pose(2).x, 5);
  assert.deepEqual(mission.pose(6), { x: 11, y: 0, z: 50, yaw: -3, tilt: 0.1 });
  assert.deepEqual(mission.pose(20), { x: 31, y: 0, z: 60, yaw: -3, tilt: 0.2 });
});

test("it turns the short way", () => {
  const { yaw } = mission.pose(2);
  assert.ok(Math.abs(yaw - Math.PI) < 0.01, `${yaw}`);
});

test("a score is known once its timestep has ended", () => {
  assert.deepEqual([0, 9.9, 10, 19.9, 20].map(mission.scs), [null, null, 0.2, 0.2, 0.8]);
});

test("the battery is told as it was when the last timestep had ended", () => {
  assert.deepEqual([0, 9.9, 10, 20].map(mission.battery), [1, 1, 0.847, 0.593]);
});

test("LiDARs tell what they met at the moment", () => {
  assert.deepEqual(mission.lidarAt(3.5), [
    { x: 10, y: 0, z: 38, ahead: false, distance: 12 },
    { x: 15, y: 0, z: 50, ahead: true, distance: 5 },
  ]);
  assert.equal(mission.lidarAt(12)[0].distance, 29.5);
  assert.deepEqual(mission.lidarAt(2), []);
});

test("the camera's picture is of the last look that has begun", () => {
  assert.deepEqual([0, 3.9, 4, 10, 14].map(mission.lookedAt), [null, null, 0, 0, 1]);
});

test("at the end, give or take rounding, it has ended", () => {
  assert.deepEqual([19.99, 20 - 1e-9, 20, 25].map(mission.phase), [
    "transmitting",
    "ended",
    "ended",
    "ended",
  ]);
});

test("an end is told with its last looks and what is known of the cause", () => {
  const of = (outcome, scs, fire_in_view) =>
    endOf({
      data: { outcome, eta_min: 0.75, battery_j: 1000 },
      steps: { scs, fire_in_view, battery_j: scs.map((_, i) => 500 - 100 * i) },
      count: scs.length,
    });
  assert.equal(
    of(0, [0.1, 0.8, 0.91], [0, 1, 1]),
    "Ended in success: it was sure of the fire. Its last two looks: SCS 80.0 % (fire in view), then 91.0 % (fire in view); threshold 75.0 %.",
  );
  assert.match(of(1, [0.8, 0.8], [0, 0]), /false alarm.*The fire was in none of these/);
  assert.match(of(1, [0.8, 0.8], [0, 1]), /false alarm.*The fire was in view, but/);
  assert.match(
    of(2, [0.3], [1]),
    /battery was empty: the next timestep would have taken more than what was left \(50\.0 %\), and that ends a mission\. No look of 1 reached .* 30\.0 %\. The fire was in view in 1 of 1\. Its only look: SCS/,
  );
  assert.match(of(2, [0.8, 0.3, 0.2], [1, 0, 0]), /1 of 3 looks reached the threshold, never enough/);
});

test("the looks that decided are the last sure ones, or the surest where the battery was empty", () => {
  const of = (outcome, scs) =>
    decidingLooks({ data: { outcome, eta_min: 0.75 }, steps: { scs }, count: scs.length });
  assert.deepEqual(of(0, [0.9, 0.1, 0.8, 0.91]), [2, 3]);
  assert.deepEqual(of(1, [0.1, 0.8]), [1]);
  assert.deepEqual(of(2, [0.1, 0.7, 0.2]), [1]);
  assert.deepEqual(of(2, [0, 0, 0]), [2], "none saw a sign");
  assert.deepEqual(of(2, []), []);
  assert.equal(mission.lookTime(1), 15.5);
});

test("a look that something harmless made sure says so", () => {
  const steps = { scs: [0.8, 0.5], fire_only_scs: [0.021, 0.5] };
  assert.match(misled({ steps }, 0), /without it the SCS would have been 2\.1 %/);
  assert.equal(misled({ steps }, 1), "");
  assert.equal(misled({ steps: { scs: [0.8] } }, 0), "");
  const at = (look) => misleader({ data: { distractors: { strongest: [4, 2] } }, steps }, look);
  assert.deepEqual([0, 1, null].map(at), [4, -1, -1], "one that changes no score was not taken for fire");
});

test("bars of predicted rewards have one scale in the whole mission", () => {
  const decisions = [
    { robot_rewards: [-0.5, null, 0.1] },
    null,
    { robot_rewards: [] },
    { robot_rewards: [-2, 0, 0] },
  ];
  assert.deepEqual(rewardRange({ data: { decisions } }), [-2, 0.1]);
  assert.equal(rewardRange({ data: { decisions: [null] } }), null);
});

test("energy adds up by part", () => {
  const sums = energySoFar(data.steps);
  assert.deepEqual(
    sums.map((parts) => Math.round(1000 * parts.reduce((a, b) => a + b, 0))),
    [1530, 4070],
  );
});

test("the clock plays at its speed, ends, and begins again", () => {
  let now = 0;
  const frames = [];
  const clock = makeClock(30, { now: () => now, frame: (tick) => frames.push(tick) });
  const seen = [];
  clock.listen((time, playing) => seen.push([time, playing]));
  clock.setSpeed(10);
  clock.toggle();
  now = 1000;
  frames.shift()();
  now = 4000;
  frames.shift()();
  assert.deepEqual(seen, [
    [0, true],
    [10, true],
    [30, false],
  ]);
  assert.equal(frames.length, 0);
  clock.toggle();
  assert.deepEqual(seen.at(-1), [0, true]);
  clock.set(99);
  assert.equal(clock.time(), 30);
});
