// The mission in time: confidence with its threshold, energy by part, battery, rate, who looked. A click goes there.
import { scaleLinear } from "d3-scale";
import { stack } from "d3-shape";
import { area, curveLinear, curveStepAfter, line } from "d3-shape";
import { axisBottom } from "d3-axis";
import { select } from "d3-selection";
import { el, svg } from "../lib/dom.js";
import { number } from "../lib/format.js";
import { EXECUTION_LABELS } from "./mission.js";

const LANES = [
  ["SCS, %", 76],
  ["energy so far, kJ", 70],
  ["battery, %", 44],
  ["rate, Mbit/s", 44],
  ["looks with", 20],
];
const LEFT = 152,
  RIGHT = 14,
  GAP = 16;
// The colours of the same parts in the report; movement, which there holds the hovering, in two shades.
export const PARTS = [
  {
    label: "movement",
    variable: "--part-1",
    of: (s, i) => s.horizontal_j[i] + s.ascent_j[i] + s.descent_j[i] + s.hover_turning_j[i],
  },
  {
    label: "hovering while it looks",
    variable: "--part-1b",
    of: (s, i) => s.hover_sensing_j[i] + s.hover_computing_j[i] + s.hover_transmitting_j[i],
  },
  {
    label: "computation",
    variable: "--part-2",
    of: (s, i) => s.computation_j[i],
  },
  {
    label: "transmission",
    variable: "--part-3",
    of: (s, i) => s.transmission_j[i],
  },
  {
    label: "sensing",
    variable: "--part-4",
    of: (s, i) => s.sensing_j[i],
  },
];
const MODELS = ["--offloaded", "--full", "--quantized"];

/** Sums of energy in kJ by part after each timestep. */
export function energySoFar(steps) {
  const sums = PARTS.map(() => 0);
  return steps.k.map((_, i) => PARTS.map((part, p) => (sums[p] += part.of(steps, i) / 1000)));
}

export function timelines(mission, clock) {
  const place = el("div", { class: "timelines" });
  const legend = el(
    "p",
    { class: "key legend" },
    [
      ...PARTS.map((part) => [part.label, part.variable]),
      ...EXECUTION_LABELS.map((label, i) => [label, MODELS[i]]),
    ].map(([label, variable]) =>
      el(
        "span",
        {},
        el("span", { class: "square", style: `--c:var(${variable})`, "aria-hidden": "true" }),
        label,
      ),
    ),
  );
  let cursor = null,
    x = null;
  const draw = () => {
    const width = Math.max(280, place.clientWidth);
    const height = LANES.reduce((sum, [, h]) => sum + h + GAP, 0) + 26;
    x = scaleLinear([0, clock.end], [LEFT, width - RIGHT]);
    const root = svg("svg", {
      viewBox: `0 0 ${width} ${height}`,
      width,
      height,
      role: "img",
      "aria-label": `Time lines of ${mission.data.label}: ${summary(mission)}`,
    });
    let top = 4;
    const lanes = [scsLane, energyLane, batteryLane, rateLane, modelLane];
    LANES.forEach(([label, h], i) => {
      root.append(svg("text", { class: "lane", x: 4, y: top + h / 2 + 4 }, label));
      root.append(svg("line", { class: "ground", x1: LEFT, x2: width - RIGHT, y1: top + h, y2: top + h }));
      root.append(lanes[i](mission, x, top, h));
      top += h + GAP;
    });
    const axis = svg("g", { class: "axis", transform: `translate(0,${top - 6})` });
    const minutes = scaleLinear([0, clock.end / 60], x.range());
    select(axis).call(
      axisBottom(minutes)
        .ticks(Math.max(3, width / 90))
        .tickFormat((m) => `${m} min`),
    );
    cursor = svg("line", { class: "cursor", y1: 0, y2: height - 22 });
    root.append(axis, cursor);
    root.addEventListener("pointerdown", (event) => {
      const box = root.getBoundingClientRect();
      clock.set(x.invert(((event.clientX - box.left) * width) / box.width));
    });
    place.replaceChildren(root);
  };
  return {
    node: el("div", {}, place, legend),
    draw,
    update(time) {
      if (!cursor) draw();
      cursor.setAttribute("x1", x(time));
      cursor.setAttribute("x2", x(time));
    },
  };
}

const summary = ({ data, steps, count }) =>
  `${count} timesteps, highest SCS ${number(100 * Math.max(...steps.scs), 1)} %, ${number(data.energy_j / 1000, 2)} kJ`;

/** Numbers of a lane's scale at its left: its ends, and what else is worth reading. */
const ticks = (x, y, values) =>
  values.map(([value, label, extra]) =>
    svg(
      "text",
      {
        class: extra ? `lane tick ${extra}` : "lane tick",
        x: x.range()[0] - 6,
        y: y(value) + 4,
        "text-anchor": "end",
      },
      label,
    ),
  );

const ends = ({ steps }) => steps.begin_s.map((begin, i) => begin + steps.duration_s[i]);

function scsLane(mission, x, top, height) {
  const y = scaleLinear([0, 1], [top + height, top]);
  const { data, steps } = mission;
  const at = ends(mission);
  return svg(
    "g",
    {},
    svg("line", {
      class: "threshold",
      x1: x.range()[0],
      x2: x.range()[1],
      y1: y(data.eta_min),
      y2: y(data.eta_min),
    }),
    ticks(x, y, [
      [0, "0"],
      [data.eta_min, number(100 * data.eta_min, 0), "of-threshold"],
      ...(data.eta_min < 0.85 ? [[1, "100"]] : []),
    ]),
    steps.scs.map((scs, i) => [
      svg("line", { class: "stem", x1: x(at[i]), x2: x(at[i]), y1: y(0), y2: y(scs) }),
      svg("circle", {
        class: scs >= data.eta_min ? "look reliable" : "look",
        cx: x(at[i]),
        cy: y(scs),
        r: 3.4,
      }),
    ]),
  );
}

function energyLane(mission, x, top, height) {
  const sums = energySoFar(mission.steps);
  const at = [0, ...ends(mission)];
  const rows = [PARTS.map(() => 0), ...sums].map((values, i) => ({ at: at[i], values }));
  const highest = rows.at(-1).values.reduce((a, b) => a + b, 0);
  const y = scaleLinear([0, highest || 1], [top + height, top]);
  const layers = stack()
    .keys(PARTS.map((_, p) => p))
    .value((row, p) => row.values[p])(rows);
  return svg(
    "g",
    {},
    layers.map((layer, p) =>
      svg("path", {
        style: `fill:var(${PARTS[p].variable})`,
        d: area(
          (d) => x(d.data.at),
          (d) => y(d[0]),
          (d) => y(d[1]),
        )(layer),
      }),
    ),
    ticks(x, y, [
      [0, "0"],
      [highest || 1, number(highest, 1)],
    ]),
  );
}

/** A line through [seconds, value]. */
function trace(points, x, y, curve = curveLinear) {
  const path = line(
    (p) => x(p[0]),
    (p) => y(p[1]),
  ).curve(curve);
  return svg("path", { class: "trace", d: path(points) });
}

function batteryLane(mission, x, top, height) {
  const y = scaleLinear([0, 1], [top + height, top]);
  const points = [
    [0, 1],
    ...ends(mission).map((t, i) => [t, mission.steps.battery_j[i] / mission.data.battery_j]),
  ];
  return svg(
    "g",
    {},
    trace(points, x, y),
    ticks(x, y, [
      [0, "0"],
      [1, "100"],
    ]),
  );
}

function rateLane(mission, x, top, height) {
  const { steps } = mission;
  const highest = Math.max(...steps.rate_bps, 1);
  const y = scaleLinear([0, highest], [top + height, top]);
  const points = [
    ...steps.begin_s.map((t, i) => [t, steps.rate_bps[i]]),
    [mission.data.duration_s, steps.rate_bps.at(-1)],
  ];
  return svg(
    "g",
    {},
    trace(points, x, y, curveStepAfter),
    ticks(x, y, [
      [0, "0"],
      [highest, number(highest / 1e6, 0)],
    ]),
  );
}

const modelLane = ({ steps }, x, top, height) =>
  svg(
    "g",
    {},
    steps.k.map((_, i) =>
      svg("rect", {
        style: `fill:var(${MODELS[steps.execution[i]]})`,
        x: x(steps.begin_s[i]),
        width: Math.max(1, x(steps.begin_s[i] + steps.duration_s[i]) - x(steps.begin_s[i]) - 1),
        y: top,
        height,
      }),
    ),
  );
