// What the agents thought in the present timestep, and what came of it.
import { scaleLinear } from "d3-scale";
import { button, el, svg } from "../lib/dom.js";
import { number } from "../lib/format.js";
import { shareColour } from "../lib/palette.js";
import { decidingLooks, decidingName, endOf, EXECUTION_LABELS, misled } from "./mission.js";

const WORDS =
  "random: a motion drawn by chance, with probability ε (epsilon, which falls while missions go on); greedy: the candidate of the highest predicted reward; " +
  "admitted: candidates that stay within the world and the ranges of the moment. Grey: still to come.";

/** Why the mission ended, told from the start, with the way to the look that decided it. */
export function endNote(mission, clock) {
  const looks = decidingLooks(mission);
  return el(
    "p",
    { class: "end" },
    endOf(mission),
    " ",
    looks.length > 0 &&
      button(`Jump to ${decidingName(mission)}`, () => clock.set(mission.lookTime(looks.at(-1))), {
        class: "jump",
      }),
  );
}

export function decisionPanel(mission) {
  const now = el("div", { class: "now" });
  const stage1 = el("div", { class: "stage" });
  const stage2 = el("div", { class: "stage" });
  const range = rewardRange(mission);
  const node = el(
    "div",
    { class: "panel" },
    now,
    el("div", { class: "stages" }, stage1, stage2),
    el("p", { class: "key" }, WORDS),
  );
  let shown = "";
  return {
    node,
    update(time) {
      const pose = mission.pose(time);
      const i = mission.stepAt(time);
      now.replaceChildren(...nowText(mission, time, pose, i));
      node.dataset.x = pose.x;
      node.dataset.y = pose.y;
      node.dataset.z = pose.z;
      node.dataset.step = i + 1;
      // What it did and found is told as such once it has happened.
      const looked = mission.lookedAt(time) === i;
      const ended = mission.ended(time);
      const now_shown = `${i} ${looked} ${ended}`;
      if (now_shown === shown) return;
      shown = now_shown;
      stage1.replaceChildren(...stageOne(mission, i, ended));
      stage2.replaceChildren(...stageTwo(mission, i, looked, ended, range));
    },
  };
}

const value = (label, text) => el("span", { class: "value" }, el("small", {}, label), el("b", {}, text));

function nowText(mission, time, pose, i) {
  const { steps, data } = mission;
  const scs = mission.scs(time);
  return [
    value("timestep", `${i + 1} of ${mission.count}`),
    value("now", mission.phase(time)),
    value("SCS, last look", scs === null ? "–" : `${number(100 * scs, 1)} %`),
    value("threshold", `${number(100 * data.eta_min, 0)} %`),
    value("battery", `${number(100 * mission.battery(time), 1)} %`),
    value("rate", `${number(steps.rate_bps[i] / 1e6, 1)} Mbit/s`),
    value("at", `${number(pose.x, 0)}, ${number(pose.y, 0)}, ${number(pose.z, 0)} m`),
    value("LiDAR, nearest", nearest(mission, time)),
  ];
}

function nearest(mission, time) {
  const met = mission.lidarAt(time);
  if (met.length === 0) return `nothing in ${number(mission.data.lidar.range_m, 0)} m`;
  const least = met.reduce((a, b) => (b.distance < a.distance ? b : a));
  return `${number(least.distance, 1)} m${least.ahead ? " ahead" : ""}`;
}

/** The frame that the camera of a pixel mission saw in its last look. */
export function cameraPicture(mission) {
  const { frames } = mission.data;
  if (!frames) return null;
  const image = el("img", { width: frames.width_px, height: frames.height_px, alt: "" });
  const told = el("figcaption", { class: "key" });
  const node = el("figure", { class: "camera" }, image, told);
  let shown;
  return {
    node,
    update(time) {
      const i = mission.lookedAt(time);
      if (i === shown) return;
      shown = i;
      const jpeg = i === null ? undefined : frames.jpeg[i];
      image.hidden = !jpeg;
      if (jpeg) image.src = `data:image/jpeg;base64,${jpeg}`;
      else image.removeAttribute("src");
      image.alt = jpeg ? `What the camera saw in timestep ${i + 1}` : "";
      told.textContent = jpeg
        ? `timestep ${i + 1}, frame ${frames.number + 1} of its ${mission.data.camera.frames}: fire ${mission.steps.fire_in_view[i] ? "" : "not "}in view`
        : "the camera has not looked yet";
    },
  };
}

function stageOne(mission, i, ended) {
  const { steps } = mission;
  const decision = mission.data.decisions[i];
  const head = el("h3", {}, "Stage 1 · the remote controller moves the robot");
  if (!decision) return [head, el("p", { class: "key" }, mission.data.decisions_note ?? "")];
  const moved = Math.hypot(steps.command_dx_m[i], steps.command_dy_m[i], steps.command_dz_m[i]);
  const expected = steps.rc_predicted_reward[i];
  return [
    head,
    el(
      "p",
      {},
      el("b", {}, decision.rule),
      `: ${number(moved, 1)} m; ${decision.why}; ε ${number(steps.epsilon[i], 3)}`,
    ),
    decision.candidates.length > 0
      ? rose(mission, i, decision)
      : el("p", { class: "key" }, "No candidates: this motion was not chosen by predicted reward."),
    el(
      "p",
      { class: "key" },
      decision.candidates.length > 0 && `${decision.drawn} candidates, ${decision.admitted} admitted; `,
      expected !== null && `expected ${number(expected, 3)}, `,
      el(
        "span",
        { class: ended ? undefined : "future" },
        `${ended ? "came out" : "will come out"} ${number(steps.reward[i], 3)}${steps.halted[i] ? "; halted by an obstacle" : ""}`,
      ),
    ),
  ];
}

/** Candidates from above, coloured by predicted reward; the one that was flown is thick. */
function rose(mission, i, { candidates }) {
  const { steps } = mission;
  const chosen = [steps.command_dx_m[i], steps.command_dy_m[i]];
  const reach = Math.max(1, ...candidates.map(([dx, dy]) => Math.hypot(dx, dy)), Math.hypot(...chosen));
  const size = 170;
  const at = scaleLinear([-reach, reach], [8, size - 8]);
  const rewards = candidates.map((c) => c[3]);
  const low = Math.min(...rewards),
    span = Math.max(1e-9, Math.max(...rewards) - low);
  const lines = [...candidates].reverse().map(([dx, dy, , reward]) =>
    svg("line", {
      x1: at(0),
      y1: at(0),
      x2: at(dx),
      y2: size - at(dy),
      stroke: shareColour((reward - low) / span).fill,
    }),
  );
  return el(
    "div",
    { class: "rose" },
    svg(
      "svg",
      {
        viewBox: `0 0 ${size} ${size}`,
        width: size,
        height: size,
        role: "img",
        "aria-label": `${candidates.length} candidate motions seen from above; predicted rewards ${number(low, 3)} to ${number(low + span, 3)}`,
      },
      svg("circle", { cx: size / 2, cy: size / 2, r: size / 2 - 8, class: "ring" }),
      lines,
      svg("line", { class: "chosen", x1: at(0), y1: at(0), x2: at(chosen[0]), y2: size - at(chosen[1]) }),
      svg("circle", { class: "tip", cx: at(chosen[0]), cy: size - at(chosen[1]), r: 4 }),
    ),
    el(
      "p",
      { class: "key" },
      "predicted reward",
      el("span", {
        class: "ramp-colours",
        style: `background:linear-gradient(90deg,${[0, 0.25, 0.5, 0.75, 1].map((s) => shareColour(s).fill).join(",")})`,
      }),
      `${number(low, 3)} to ${number(low + span, 3)}; north is up`,
    ),
  );
}

/** Without the predictions where they are drawn. */
const reasons = (text, drawn) =>
  (drawn ? text.split("\n").filter((line) => line.trimStart().startsWith(">")) : text.trimEnd().split("\n"))
    .map((line) => line.replace(/^ {2}/, ""))
    .join("\n");

/** [lowest, highest] of what the robot's network predicted in the whole mission, null where it was not asked: one scale, so that bars of different timesteps can be compared. */
export function rewardRange({ data }) {
  const all = data.decisions
    .flatMap((decision) => decision?.robot_rewards ?? [])
    .filter((reward) => reward !== null);
  return all.length > 0 ? [Math.min(...all), Math.max(...all)] : null;
}

function stageTwo(mission, i, looked, ended, range) {
  const { steps, data } = mission;
  const decision = data.decisions[i];
  const done = EXECUTION_LABELS[steps.execution[i]];
  const rewards = decision?.robot_rewards ?? [];
  const known = rewards.filter((reward) => reward !== null);
  const [low, high] = range ?? [0, 1];
  const width = scaleLinear([low, Math.max(high, low + 1e-9)], [2, 100]);
  const why = misled(mission, i);
  return [
    el("h3", {}, `Stage 2 · the robot ${looked ? "looks" : "will look"}`),
    el(
      "p",
      { class: looked ? undefined : "future" },
      el("b", {}, done),
      steps.execution_random[i] ? ", at random" : "",
    ),
    known.length > 0 &&
      el(
        "div",
        { class: looked ? "predictions" : "predictions future" },
        el("p", { class: "key" }, "predicted reward (higher is better)"),
        rewards.map((reward, e) =>
          reward === null
            ? null
            : el(
                "div",
                { class: e === steps.execution[i] ? "prediction taken" : "prediction" },
                el("span", {}, EXECUTION_LABELS[e]),
                el(
                  "span",
                  { class: "track" },
                  el("span", { class: "fill", style: `width:${width(reward)}%` }),
                ),
                el("span", {}, number(reward, 3)),
              ),
        ),
        el(
          "div",
          { class: "prediction scale" },
          el("span", {}, "scale of the mission"),
          el("span", { class: "ends" }, el("span", {}, number(low, 3)), el("span", {}, number(high, 3))),
          el("span"),
        ),
      ),
    decision &&
      el("pre", { class: looked ? undefined : "future" }, reasons(decision.execution_text, known.length > 0)),
    el(
      "p",
      { class: ended ? "key" : "key future" },
      `${ended ? "" : "will be: "}${data.camera.frames} frames: mean ${number(steps.confidence_mean[i], 3)}, sd ${number(steps.confidence_sd[i], 3)}, SCS ${number(steps.scs[i], 3)}; fire ${steps.fire_in_view[i] ? "" : "not "}in view; ${number(steps.total_j[i], 0)} J`,
      why && `; ${why}`,
    ),
  ].filter(Boolean);
}
