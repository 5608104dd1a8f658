// Energy against success: an arm is a point with intervals both ways, the paper's value a diamond tied to it.
import { extent } from "d3-array";
import { scaleLinear } from "d3-scale";
import {
  symbol,
  symbolCircle,
  symbolCross,
  symbolDiamond,
  symbolSquare,
  symbolStar,
  symbolTriangle,
  symbolWye,
} from "d3-shape";
import { axes, canvas, figure } from "../lib/chart.js";
import { asButton, svg } from "../lib/dom.js";
import { count, withInterval } from "../lib/format.js";
import { OUTCOMES } from "../lib/palette.js";
import { tableBehind } from "../lib/table.js";
import { withTooltip } from "../lib/tooltip.js";

const SHAPES = [
  symbolCircle,
  symbolSquare,
  symbolTriangle,
  symbolStar,
  symbolCross,
  symbolWye,
  symbolDiamond,
];
const MARGIN = { top: 30, right: 24, bottom: 46, left: 46 };

export function plane(model, store) {
  const { node, picture, behind, told, heading } = figure("plane", "Energy against success", "");
  return {
    node,
    update(state) {
      const points = pointsOf(model, state);
      picture.replaceChildren(draw(picture, points, state, store));
      told.textContent = caption(points, state);
      heading.textContent = title(state);
      behind.replaceChildren(numbers(points));
    },
  };
}

const ofSuccess = (state) => state.outcome === "all" || state.outcome === "0";

/** Of the share that is drawn. */
export const title = ({ outcome }) =>
  `Energy against ${{ 1: "false alarms", 2: "empty batteries" }[outcome] ?? "success"}`;

/** Of what is drawn, and no more. */
export function caption(points, state) {
  const share = ofSuccess(state) ? "in success" : "as chosen above";
  const of = state.outcome === "all" ? "a mission" : "the missions chosen";
  return [
    `Each mark is an arm: mean energy of ${of} and the share of missions that ended ${share}, with 95 % intervals on both axes.`,
    ofSuccess(state) && "Up and left is better.",
    ofSuccess(state) &&
      undominated(points).length > 1 &&
      "The dashed line joins the arms that no other beats in both means, and is as uncertain as they are.",
    points.some((p) => p.paper) &&
      "A hollow diamond is the paper's value, a dotted line ties it to our mark of the same arm.",
  ]
    .filter(Boolean)
    .join(" ");
}

function pointsOf(model, state) {
  const energy = model.byName.total_energy_kj;
  const share = model.byName[OUTCOMES.find((o) => o.id === state.outcome)?.metric ?? "msr_pct"];
  const all = state.site === "all" && state.outcome === "all";
  return model.chosen(state).flatMap((arm) => {
    const x = model.cell(arm, energy.name, state);
    // Of all missions there: among those of one outcome it would be 100 %.
    const y = model.cell(arm, share.name, { site: state.site, outcome: "all" });
    if (!x || !y) return [];
    const theirs = all && arm.paper[energy.name] && arm.paper[share.name];
    return [{ arm, x, y, energy, share, paper: theirs ? { x: arm.paper[energy.name], y: theirs } : null }];
  });
}

function draw(place, points, state, store) {
  const narrow = place.clientWidth < 560;
  const ground = canvas(place, {
    height: narrow ? 340 : 440,
    label: "Energy against success, one mark for each arm",
    margin: MARGIN,
  });
  if (points.length === 0) {
    ground.inner.append(svg("text", { x: 10, y: 40, class: "empty" }, "No mission of this selection."));
    return ground.root;
  }
  const xs = points
    .flatMap((p) => [p.x.value, p.x.lo, p.x.hi, p.paper?.x.value])
    .filter((v) => v !== null && v !== undefined);
  const ys = points
    .flatMap((p) => [p.y.value, p.y.lo, p.y.hi, p.paper?.y.value])
    .filter((v) => v !== null && v !== undefined);
  const [bottom, top] = extent(ys);
  const pad = Math.max(2, (top - bottom) * 0.08);
  const x = scaleLinear([0, Math.max(...xs) * 1.06], [0, ground.width]).nice();
  const y = scaleLinear([Math.max(0, bottom - pad), Math.min(100.5, top + pad)], [ground.height, 0]);
  axes(ground, x, y, {
    x: `energy of a mission, ${points[0].energy.unit}`,
    y: `${points[0].share.label}, %`,
  });
  if (ofSuccess(state)) frontier(ground, points, x, y);
  for (const p of points) if (p.paper) theirs(ground, p, x, y);
  for (const p of points) ours(ground, p, x, y, store, state);
  label(ground, points, x, y, narrow);
  return ground.root;
}

/** Arms that no other beats in both means, the most frugal first. */
export const undominated = (points) =>
  points
    .filter(
      (p) =>
        !points.some(
          (q) =>
            q !== p &&
            q.x.value <= p.x.value &&
            q.y.value >= p.y.value &&
            (q.x.value < p.x.value || q.y.value > p.y.value),
        ),
    )
    .sort((a, b) => a.x.value - b.x.value);

function frontier(ground, points, x, y) {
  const best = undominated(points);
  if (best.length < 2) return;
  ground.inner.append(
    svg("path", { class: "frontier", d: `M${best.map((p) => `${x(p.x.value)},${y(p.y.value)}`).join("L")}` }),
  );
}

function theirs(ground, p, x, y) {
  const at = [x(p.paper.x.value), y(p.paper.y.value)];
  ground.inner.append(
    svg("line", { class: "tie", x1: x(p.x.value), y1: y(p.y.value), x2: at[0], y2: at[1] }),
    withTooltip(
      svg("path", {
        class: "diamond",
        style: `--c:${p.arm.colour}`,
        transform: `translate(${at})`,
        d: symbol(symbolDiamond, 70)(),
      }),
      () => [
        `${p.arm.label}, the paper`,
        `${p.paper.x.text} ${p.energy.unit}`,
        `${p.paper.y.text} % ${p.share.label}`,
      ],
    ),
  );
}

function ours(ground, p, x, y, store, state) {
  const at = [x(p.x.value), y(p.y.value)];
  const tell = `${p.arm.label}: ${withInterval(p.x, p.energy)}, ${p.share.label} ${withInterval(p.y, p.share)}`;
  const mark = svg(
    "g",
    {
      class: "mark",
      style: `--c:${p.arm.colour}`,
      "data-arm": p.arm.key,
      "aria-pressed": String(state.arms.includes(p.arm.key)),
      ...asButton(tell, () => store.toggleArm(p.arm.key)),
    },
    p.x.lo !== null &&
      svg("line", { class: "whisker", x1: x(Math.max(0, p.x.lo)), x2: x(p.x.hi), y1: at[1], y2: at[1] }),
    p.y.lo !== null &&
      svg("line", {
        class: "whisker",
        x1: at[0],
        x2: at[0],
        y1: y(Math.max(p.y.lo, y.domain()[0])),
        y2: y(Math.min(p.y.hi, y.domain()[1])),
      }),
    svg("path", { transform: `translate(${at})`, d: symbol(SHAPES[p.arm.index % SHAPES.length], 130)() }),
  );
  withTooltip(mark, () => [
    p.arm.label,
    `energy ${withInterval(p.x, p.energy)}`,
    `${p.share.label} ${withInterval(p.y, p.share)}`,
    `${count(p.y.missions)} missions`,
    p.paper && `paper: ${p.paper.x.text} ${p.energy.unit}, ${p.paper.y.text} %`,
  ]);
  ground.inner.append(mark);
}

/** Names beside their marks, moved apart where they would lie on one another. */
function label(ground, points, x, y, narrow) {
  const size = narrow ? 12 : 14;
  const taken = [
    box(-8, -24, 130, 16),
    ...points.map((p) => box(x(p.x.value) - 8, y(p.y.value) - 8, 16, 16)),
  ];
  for (const p of points) {
    const at = [x(p.x.value), y(p.y.value)];
    const width = p.arm.label.length * size * 0.58;
    const places = [
      [12, -8],
      [12, 18],
      [-12 - width, -8],
      [-12 - width, 18],
      [12, -26],
      [12, 36],
      [-12 - width, -26],
      [-12 - width, 36],
      [12, 54],
      [12, -44],
    ];
    const fits = ([dx, dy]) => {
      const here = box(at[0] + dx, at[1] + dy - size, width, size + 3);
      return (
        here.x >= 0 &&
        here.x + width <= ground.width + 20 &&
        here.y > -24 &&
        here.y + size < ground.height &&
        !taken.some((other) => touch(other, here))
      );
    };
    const [dx, dy] = places.find(fits) ?? places[0];
    taken.push(box(at[0] + dx, at[1] + dy - size, width, size + 3));
    ground.inner.append(
      svg(
        "text",
        {
          class: "arm-label",
          "aria-hidden": "true",
          style: `--c:${p.arm.colour};font-size:${size}px`,
          x: at[0] + dx,
          y: at[1] + dy,
        },
        p.arm.label,
      ),
    );
  }
}

const box = (x, y, width, height) => ({ x, y, width, height });
export const touch = (a, b) =>
  a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;

const numbers = (points) =>
  tableBehind(
    [
      { label: "arm", text: (p) => p.arm.label, key: (p) => p.arm.label, left: true },
      { label: "energy, kJ", text: (p) => withInterval(p.x, p.energy), key: (p) => p.x.value },
      {
        label: `${points[0]?.share.label ?? "share"}, %`,
        text: (p) => withInterval(p.y, p.share),
        key: (p) => p.y.value,
      },
      { label: "paper", text: (p) => (p.paper ? `${p.paper.x.text} kJ, ${p.paper.y.text} %` : "–") },
    ],
    points,
    "Energy against success",
  );
