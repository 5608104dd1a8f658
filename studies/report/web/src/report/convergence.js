// How sure after how many missions: half of the interval's width against the number of missions, both logarithmic.
import { scaleLog } from "d3-scale";
import { line } from "d3-shape";
import { axes, canvas, figure, labelWidth, logTicks } from "../lib/chart.js";
import { el, svg } from "../lib/dom.js";
import { count, number } from "../lib/format.js";
import { tableBehind } from "../lib/table.js";
import { withTooltip } from "../lib/tooltip.js";

const MARGIN = { top: 26, right: 90, bottom: 46, left: 52 };
const QUANTITIES = [
  ["total_energy_kj", "kJ of mean energy"],
  ["msr_pct", "points of success"],
];

export function convergence(model, store) {
  const caption =
    "Of all missions, whatever site or outcome is chosen. Half of the width of the 95 % interval that the first n missions of an arm give, from 100 missions on; both axes are logarithmic. Solid: with the luck of training, which more missions of the " +
    "same networks do not average out; dashed: over missions alone, which falls as one over the square root of n.";
  const { node, picture, behind } = figure("convergence", "How sure after how many missions", caption);
  picture.classList.add("two");
  return {
    node,
    update(state) {
      const places = QUANTITIES.map(() => el("div"));
      picture.replaceChildren(...places);
      const lists = QUANTITIES.map(([metric]) => curves(model, metric, state));
      places.forEach((place, i) => place.append(draw(place, lists[i], QUANTITIES[i][1], store)));
      behind.replaceChildren(numbers(lists));
    },
  };
}

const curves = (model, metric, state) =>
  model.chosen(state).flatMap((arm) => {
    const found = arm.convergence[metric];
    if (!found || found.missions.length < 2) return [];
    return [{ arm, metric, points: fromEnough(pointsOf(found)) }];
  });

const pointsOf = (found) =>
  found.missions.map((n, i) => ({ n, all: found.half_width[i], alone: found.half_width_missions[i] }));

const ENOUGH = 100;

/** Of fewer missions a half-width says little and would stretch the axis; kept where there would be no curve else. */
export function fromEnough(points) {
  const enough = points.filter(({ n }) => n >= ENOUGH);
  return enough.length > 1 ? enough : points;
}

const LADDER = [1, 2, 5, 10];

/** The next of 1, 2, 5 times a power of ten, downwards or upwards. */
export function roundDown(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return Number((LADDER.findLast((step) => step * power <= value * (1 + 1e-9)) * power).toPrecision(1));
}
export function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return Number((LADDER.find((step) => step * power >= value * (1 - 1e-9)) * power).toPrecision(1));
}

function draw(place, list, label, store) {
  const ground = canvas(place, {
    height: 320,
    label: `Half-width in ${label} against missions`,
    margin: { ...MARGIN, right: labelWidth(list) },
  });
  const values = list.flatMap((c) => c.points.flatMap((p) => [p.all, p.alone])).filter((v) => v > 0);
  if (values.length === 0) {
    ground.inner.append(svg("text", { x: 0, y: 30, class: "empty" }, "Too few missions for a curve."));
    return ground.root;
  }
  const ns = list.flatMap((c) => c.points.map((p) => p.n));
  const x = scaleLog([Math.min(...ns), Math.max(...ns)], [0, ground.width]);
  const y = scaleLog([roundDown(Math.min(...values)), roundUp(Math.max(...values))], [ground.height, 0]);
  axes(
    ground,
    x,
    y,
    { x: "missions of an arm", y: `half-width, ${label}` },
    { xValues: logTicks(x, 34), xFormat: count, yValues: logTicks(y, 14), yFormat: (v) => String(v) },
  );
  const path = (key) =>
    line(
      (p) => x(p.n),
      (p) => y(p[key]),
    ).defined((p) => p[key] > 0);
  for (const { arm, points } of list) {
    const last = points.at(-1);
    const group = svg(
      "g",
      { class: "curve", style: `--c:${arm.colour}`, onclick: () => store.toggleArm(arm.key) },
      svg("path", { class: "alone", d: path("alone")(points) }),
      svg("path", { d: path("all")(points) }),
    );
    withTooltip(group, () => [
      arm.label,
      `after ${count(last.n)} missions ± ${number(last.all, 2)} ${label}`,
      `over missions alone ± ${number(last.alone, 2)}`,
    ]);
    ground.inner.append(group);
  }
  endLabels(ground, list, x, y);
  return ground.root;
}

function endLabels(ground, list, x, y) {
  const labels = list
    .map(({ arm, points }) => ({ arm, at: y(points.findLast((p) => p.all > 0)?.all ?? y.domain()[0]) }))
    .sort((a, b) => a.at - b.at);
  let free = 0;
  for (const { arm, at } of labels) {
    const here = Math.max(at + 4, free);
    free = here + 14;
    ground.inner.append(
      svg(
        "text",
        { class: "row-label small", style: `--c:${arm.colour}`, x: ground.width + 6, y: here },
        arm.label,
      ),
    );
  }
}

const numbers = (lists) =>
  tableBehind(
    [
      { label: "arm", text: (c) => c.arm.label, key: (c) => c.arm.label, left: true },
      {
        label: "half-width of",
        text: (c) => (c.metric === "msr_pct" ? "success, points" : "energy, kJ"),
        key: (c) => c.metric,
        left: true,
      },
      { label: "missions", text: (c) => count(c.points.at(-1).n), key: (c) => c.points.at(-1).n },
      {
        label: "with training",
        text: (c) => number(c.points.at(-1).all, 3),
        key: (c) => c.points.at(-1).all,
      },
      {
        label: "missions alone",
        text: (c) => number(c.points.at(-1).alone, 3),
        key: (c) => c.points.at(-1).alone,
      },
    ],
    lists.flat(),
    "Half-widths over all missions",
  );
