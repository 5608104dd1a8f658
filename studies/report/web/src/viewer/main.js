import "../viewer.css";
import { button, el } from "../lib/dom.js";
import { number } from "../lib/format.js";
import { shareColour } from "../lib/palette.js";
import { isDark } from "../lib/relief.js";
import { makeClock } from "./clock.js";
import { makeMap } from "./map2d.js";
import { decidingLooks, decidingName, makeMission, OUTCOMES } from "./mission.js";
import { cameraPicture, decisionPanel, endNote } from "./panel.js";
import { NEAR_M, RAY_COLOURS } from "./robot3d.js";
import { hasWebGl, makeScene } from "./scene3d.js";
import { timelines } from "./timelines.js";

const SPEEDS = [1, 2, 5, 10, 20, 60];
const LOOKS = { overview: "Overview", follow: "Follow", onboard: "On board" };

const data = JSON.parse(document.getElementById("page-data").textContent);
const flat = !hasWebGl() || new URLSearchParams(location.hash.slice(1)).has("map");
const clock = makeClock(Math.max(...data.missions.map((mission) => mission.duration_s)));

const columns = data.missions.map((missionData) => {
  const mission = makeMission(missionData);
  const view = flat ? makeMap(data.world, mission) : makeScene(data.world, mission, isDark());
  const panel = decisionPanel(mission);
  const lines = timelines(mission, clock);
  const camera = cameraPicture(mission);
  const end = OUTCOMES[missionData.outcome];
  const node = el(
    "section",
    { class: "mission", "aria-label": missionData.name },
    el(
      "div",
      { class: "title" },
      el("h2", {}, `${missionData.label}, mission ${missionData.number}`),
      el(
        "p",
        {},
        el("b", { class: `outcome o-${missionData.outcome}` }, end),
        ` after ${mission.count} timesteps, ${number(missionData.duration_s / 60, 2)} min, ${number(missionData.energy_j / 1000, 2)} kJ`,
      ),
      !missionData.identical && el("p", { class: "note" }, "This flight differs from the stored record."),
    ),
    endNote(mission, clock),
    el("div", { class: "seen" }, view.node, camera?.node),
    el("p", { class: "key legend" }, pathLegend(), !flat && rayLegend(missionData.lidar)),
    panel.node,
    lines.node,
  );
  return { node, mission, view, panel, lines, camera };
});

const play = button("Play", () => clock.toggle(), { class: "play" });
const scrub = el("input", {
  type: "range",
  min: 0,
  max: clock.end,
  step: "any",
  value: 0,
  "aria-label": "Mission time",
  oninput: () => clock.set(Number(scrub.value)),
});
// Where the looks are that decided each mission, on the bar.
const marks = columns.flatMap(({ mission }) =>
  decidingLooks(mission).map((i) =>
    el("span", {
      class: "mark",
      style: `--at:${mission.lookTime(i) / clock.end}`,
      title: `${mission.data.label}: ${decidingName(mission).replace("the deciding", "a deciding")}`,
    }),
  ),
);
const told = el("output", { class: "time" });
const speed = el(
  "select",
  { "aria-label": "Speed", onchange: () => clock.setSpeed(Number(speed.value)) },
  SPEEDS.map((factor) => el("option", { value: factor, selected: factor === clock.speed() }, `${factor}×`)),
);
const looks = Object.entries(LOOKS).map(([id, label]) =>
  button(label, () => lookFrom(id), { "data-look": id }),
);
const same = data.missions.length > 1 && data.missions[0].scenario === data.missions[1].scenario;

document.getElementById("app").append(
  el(
    "header",
    {},
    el(
      "h1",
      {},
      el("small", {}, `ED³R · ${data.run} · `),
      data.missions.map((mission) => mission.name).join(" beside "),
    ),
    data.missions.length > 1 &&
      el(
        "p",
        { class: "key" },
        same ? "The same scenario: fire, start, radio and CPU draws are equal." : "Different scenarios.",
      ),
    ways(),
    flat && el("p", { class: "note" }, "Seen from above: this browser has no WebGL."),
  ),
  el(
    "main",
    { class: columns.length > 1 ? "beside" : "" },
    columns.map((column) => column.node),
  ),
  el(
    "div",
    { id: "controls", role: "region", "aria-label": "Time" },
    play,
    button("‹", () => step(-1), { "aria-label": "Previous timestep" }),
    button("›", () => step(1), { "aria-label": "Next timestep" }),
    el("span", { class: "scrub" }, scrub, el("span", { class: "marks", "aria-hidden": "true" }, marks)),
    told,
    speed,
    !flat && el("div", { class: "looks", role: "group", "aria-label": "Point of view" }, looks),
  ),
);

/** To the report that the page lies beside, and to the missions that it shows before and after this one. */
function ways() {
  if (!data.report) return null;
  const link = (place, mark) =>
    place && el("a", { href: encodeURI(place.file) }, mark === "‹" ? `‹ ${place.what}` : `${place.what} ›`);
  return el(
    "nav",
    { class: "ways", "aria-label": "Report and other missions" },
    el("a", { href: encodeURI(data.report) }, "← Report"),
    data.what && el("span", {}, `this mission: ${data.what}`),
    link(data.previous, "‹"),
    link(data.next, "›"),
  );
}

function pathLegend() {
  const ramp = [0, 0.25, 0.5, 0.75, 1].map((share) => shareColour(share).fill).join(",");
  return [
    el(
      "span",
      {},
      "path and stops: SCS of the look, 0 ",
      el("span", { class: "ramp-colours", style: `background:linear-gradient(90deg,${ramp})` }),
      " 1",
      !flat && "; faint: still to be flown",
    ),
    el("span", {}, flat ? "brown circles: other places for a fire" : "brown rings: other places for a fire"),
    !flat && el("span", {}, "pyramid: what the camera sees"),
    el("span", {}, "dashed line: radio link to the base station"),
    data.missions.some((mission) => mission.distractors) &&
      el(
        "span",
        {},
        "violet discs: harmless things that look like fire, drawn for this mission; bright: what the look took for fire",
      ),
  ];
}

function rayLegend({ range_m }) {
  return [
    ["a LiDAR meets a surface within " + number(range_m, 0) + " m", RAY_COLOURS.far],
    ["ahead, where the safety rule looks", RAY_COLOURS.ahead],
    [`nearer than ${NEAR_M} m`, RAY_COLOURS.near],
  ].map(([label, colour]) =>
    el("span", {}, el("span", { class: "square", style: `--c:${colour}`, "aria-hidden": "true" }), label),
  );
}

/** To the begin of the next or the previous timestep of the first mission. */
function step(by) {
  const { begin_s: begins } = data.missions[0].steps;
  const now = clock.time();
  const to =
    by > 0 ? begins.find((begin) => begin > now + 1e-6) : begins.findLast((begin) => begin < now - 1e-6);
  clock.set(to ?? (by > 0 ? clock.end : 0));
}

function lookFrom(id) {
  for (const { view } of columns) view.look(id);
  for (const choice of looks) choice.setAttribute("aria-pressed", String(choice.dataset.look === id));
}

function update(time, playing) {
  play.textContent = playing ? "Pause" : "Play";
  scrub.value = time;
  scrub.setAttribute("aria-valuetext", `${number(time / 60, 2)} minutes`);
  told.textContent = `${number(time, 1)} s of ${number(clock.end, 1)} s`;
  for (const { view, panel, lines, camera } of columns) {
    view.update(time);
    camera?.update(time);
    panel.update(time);
    lines.update(time);
  }
}

addEventListener("keydown", (event) => {
  if (event.target.closest?.("input,select,button") || event.ctrlKey || event.metaKey) return;
  const act = {
    " ": () => clock.toggle(),
    ArrowRight: () => step(1),
    ArrowLeft: () => step(-1),
    Home: () => clock.set(0),
    End: () => clock.set(clock.end),
  }[event.key];
  if (!act) return;
  event.preventDefault();
  act();
});
const drawAll = () => {
  for (const { view, lines } of columns) {
    view.draw();
    lines.draw();
  }
  update(clock.time(), clock.playing());
};
addEventListener("resize", drawAll);
clock.listen(update);
drawAll();
lookFrom("overview");
document.documentElement.dataset.ready = "yes";
