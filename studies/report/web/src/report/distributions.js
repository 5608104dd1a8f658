// How missions spread: a row for each arm, missions stacked by how they ended, with the mean and its interval.
import { max } from "d3-array";
import { scaleLinear } from "d3-scale";
import { axes, canvas, figure, labelWidth, withEnds } from "../lib/chart.js";
import { el, svg } from "../lib/dom.js";
import { count, number, plural, withInterval } from "../lib/format.js";
import { OUTCOMES } from "../lib/palette.js";
import { tableBehind } from "../lib/table.js";
import { withTooltip } from "../lib/tooltip.js";

const MEAN = { energy_kj: "total_energy_kj", duration_min: "duration_mean_min", scs_pct: "mscs_pct" };
const MARGIN = { top: 10, right: 16, bottom: 44, left: 110 };
const ROW = 58;
const NAME = 18; // above a row's bars, where there is no room beside them

export function distributions(model, store) {
  const { node, picture, controls, behind } = figure(
    "distributions",
    "How missions spread",
    "Missions of each arm by their value, stacked by how they ended, in percent of the arm's missions shown; all rows have one scale, to the fullest bin of any. The line is " +
      "the mean with its 95 % interval, the diamond the paper's. A mission without a reliable look has no confidence and is in no bin. " +
      "A click on a colour chooses the outcome.",
  );
  const buttons = model.data.histograms.scales.map((scale) =>
    el(
      "button",
      {
        type: "button",
        class: "tab",
        "data-scale": scale.column,
        onclick: () => store.set({ scale: scale.column }),
      },
      scale.label,
    ),
  );
  controls.append(
    el("div", { class: "tabs", role: "group", "aria-label": "Quantity" }, buttons),
    outcomeLegend(store),
  );
  return {
    node,
    update(state) {
      const column = MEAN[state.scale] ? state.scale : "energy_kj";
      for (const tab of buttons) tab.setAttribute("aria-pressed", String(tab.dataset.scale === column));
      const rows = model.chosen(state).map((arm) => ({
        arm,
        ...model.histogram(arm, column, state),
        metric: model.byName[MEAN[column]],
        cell: model.cell(arm, MEAN[column], state),
        paper: state.site === "all" && state.outcome === "all" ? arm.paper[MEAN[column]] : null,
      }));
      picture.replaceChildren(draw(picture, rows, store));
      behind.replaceChildren(numbers(rows));
    },
  };
}

export const outcomeLegend = (store) =>
  el(
    "div",
    { class: "legend" },
    OUTCOMES.map((outcome) =>
      el(
        "button",
        { type: "button", class: "key-button", onclick: () => store.toggle("outcome", outcome.id) },
        el("span", { class: "square", style: `--c:var(${outcome.variable})`, "aria-hidden": "true" }),
        outcome.label,
      ),
    ),
  );

function draw(place, rows, store) {
  const narrow = place.clientWidth < 560;
  const margin = { ...MARGIN, left: narrow ? 12 : labelWidth(rows) };
  const step = narrow ? ROW + NAME : ROW;
  const ground = canvas(place, {
    height: rows.length * step + margin.top + margin.bottom,
    label: "Distribution of missions, one row for each arm",
    margin,
  });
  if (rows.length === 0) return ground.root;
  const { scale } = rows[0];
  const x = scaleLinear([scale.from, scale.from + scale.step * scale.bins], [0, ground.width]);
  const ticks = withEnds(x.ticks(Math.max(3, ground.width / 90)), x);
  axes(
    ground,
    x,
    null,
    { x: `${scale.label}, ${scale.unit}` },
    { xValues: ticks, xFormat: (value) => number(value, Number.isInteger(value) ? 0 : 1) },
  );
  const fullest = fullestShare(rows);
  rows.forEach((row, i) =>
    ground.inner.append(drawRow(row, i * step, x, ground.width, { narrow, fullest }, store)),
  );
  return ground.root;
}

const totalsOf = ({ counts }) => counts[0].map((n, bin) => n + counts[1][bin] + counts[2][bin]);

/** The highest share of an arm's missions in one bin, of all arms. */
export const fullestShare = (rows) =>
  max(rows, (row) => {
    const totals = totalsOf(row);
    return max(totals) / (total(totals) || 1);
  }) || 1;

function drawRow(row, top, x, width, { narrow, fullest }, store) {
  const { counts, scale } = row;
  const totals = totalsOf(row);
  const all = total(totals) || 1;
  const y = scaleLinear([0, fullest * all], [0, ROW - 16]);
  const base = top + (narrow ? NAME : 0) + ROW - 6;
  const group = svg("g", { role: "img", "aria-label": `${row.arm.label}: ${spread(row)}` });
  group.append(
    svg("line", { class: "ground", x1: 0, x2: width, y1: base, y2: base }),
    svg("line", { class: "ground top", x1: 0, x2: width, y1: base - ROW + 16, y2: base - ROW + 16 }),
    svg(
      "text",
      { class: "tick", x: width, y: base - ROW + 13, "text-anchor": "end" },
      `${number(100 * fullest, 0)} % of missions`,
    ),
  );
  totals.forEach((inBin, bin) => {
    let up = base;
    OUTCOMES.forEach((outcome, o) => {
      const n = counts[o][bin];
      if (n === 0) return;
      const height = y(n);
      up -= height;
      const from = scale.from + bin * scale.step;
      const rect = svg("rect", {
        class: "bar",
        style: `--c:var(${outcome.variable})`,
        x: x(from) + 0.5,
        width: Math.max(1, x(from + scale.step) - x(from) - 1),
        y: up,
        height,
        onclick: () => store.toggle("outcome", outcome.id),
      });
      group.append(
        withTooltip(rect, () => [
          `${row.arm.label}, ${number(from, 1)}–${number(from + scale.step, 1)} ${scale.unit}`,
          ...OUTCOMES.map(
            (other, i) => counts[i][bin] > 0 && `${other.label}: ${plural(counts[i][bin], "mission")}`,
          ),
          `${count(inBin)} of ${count(all)}: ${number((100 * inBin) / all, 1)} %`,
        ]),
      );
    });
  });
  if (row.cell?.value !== null && row.cell) group.append(meanMark(row, x, base));
  group.append(
    svg(
      "text",
      {
        class: "row-label",
        style: `--c:${row.arm.colour}`,
        x: narrow ? 0 : -10,
        y: narrow ? top + 12 : base - 14,
        "text-anchor": narrow ? "start" : "end",
      },
      row.arm.label,
    ),
  );
  return group;
}

function meanMark({ arm, cell, metric, paper }, x, base) {
  const mark = svg(
    "g",
    { class: "mean-mark" },
    cell.lo !== null &&
      svg("line", { class: "whisker", x1: x(cell.lo), x2: x(cell.hi), y1: base + 3, y2: base + 3 }),
    svg("line", { class: "mean", x1: x(cell.value), x2: x(cell.value), y1: base - ROW + 18, y2: base + 6 }),
    paper && svg("path", { class: "diamond", d: `M${x(paper.value)},${base - 3}l5,6l-5,6l-5,-6z` }),
  );
  return withTooltip(mark, () => [
    `${arm.label}: ${metric.label}`,
    `ours ${withInterval(cell, metric)}`,
    paper && `paper ${paper.text} ${metric.unit}`,
  ]);
}

const spread = ({ counts, cell, metric }) =>
  `${metric.label} ${withInterval(cell, metric)}; ${OUTCOMES.map((o, i) => `${count(counts[i].reduce((a, b) => a + b, 0))} ${o.label}`).join(", ")}`;

const total = (list) => list.reduce((a, b) => a + b, 0);

const numbers = (rows) =>
  tableBehind(
    [
      { label: "arm", text: (r) => r.arm.label, key: (r) => r.arm.label, left: true },
      {
        label: rows[0]?.metric.heading ?? "mean",
        text: (r) => withInterval(r.cell, r.metric),
        key: (r) => r.cell?.value,
      },
      ...OUTCOMES.map((outcome, o) => ({
        label: outcome.label,
        text: (r) => count(total(r.counts[o])),
        key: (r) => total(r.counts[o]),
      })),
    ],
    rows,
    "Missions in the bins above, by outcome, with the mean",
  );
