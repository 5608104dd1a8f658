// Three pictures of stacked bars: what energy goes into, how missions end, where and with what timesteps are processed.
import { scaleLinear } from "d3-scale";
import { axes, canvas, figure, labelWidth } from "../lib/chart.js";
import { el, svg } from "../lib/dom.js";
import { withInterval } from "../lib/format.js";
import { OUTCOMES } from "../lib/palette.js";
import { tableBehind } from "../lib/table.js";
import { withTooltip } from "../lib/tooltip.js";

const MARGIN = { top: 8, right: 18, bottom: 44, left: 96 };
const ROW = 30;

const value = (cell) => cell?.value ?? 0;

export const energyParts = (model, store) =>
  stacked(model, store, {
    id: "energy",
    title: "Where the energy goes",
    caption:
      "Mean energy of a mission by what it was spent on. Movement holds the hovering while the robot senses, computes and transmits. The whisker " +
      "is the 95 % interval of the total, the diamond the paper's total.",
    axis: "energy of a mission, kJ",
    parts: [
      { label: "movement, hovering", metric: "movement_energy_kj", variable: "--part-1" },
      { label: "computation", metric: "computation_energy_kj", variable: "--part-2" },
      { label: "transmission", metric: "transmission_energy_kj", variable: "--part-3" },
      { label: "sensing", metric: "sensing_energy_kj", variable: "--part-4" },
    ],
    whisker: "total_energy_kj",
  });

export const outcomes = (model, store) =>
  stacked(model, store, {
    id: "outcomes",
    title: "How missions end",
    caption:
      "Shares of missions by their end; the whisker is the 95 % interval of success, the diamond the paper's success rate. A click on a part chooses that outcome everywhere.",
    axis: "missions, %",
    full: 100,
    ofAll: true,
    parts: OUTCOMES.map((outcome) => ({ ...outcome, choose: outcome.id })),
    whisker: "msr_pct",
  });

export const decisions = (model, store) =>
  stacked(model, store, {
    id: "decisions",
    title: "What the robot decides",
    caption:
      "Where and with which model timesteps were processed: offloaded to the remote controller (which runs the Full model), or on board with the Full or the " +
      "Quantized model. The whisker is the 95 % interval of what was offloaded, the diamond the paper's.",
    axis: "timesteps, %",
    full: 100,
    parts: [
      { label: "offloaded", metric: "or_pct", variable: "--offloaded" },
      { label: "Full, on board", metric: "model_full_pct", minus: "or_pct", variable: "--full" },
      { label: "Quantized, on board", metric: "model_quant_pct", variable: "--quantized" },
    ],
    whisker: "or_pct",
  });

function stacked(model, store, spec) {
  const { node, picture, controls, behind } = figure(spec.id, spec.title, spec.caption);
  controls.append(
    el(
      "div",
      { class: "legend" },
      spec.parts.map((part) =>
        el(
          part.choose ? "button" : "span",
          part.choose
            ? { type: "button", class: "key-button", onclick: () => store.toggle("outcome", part.choose) }
            : {},
          el("span", { class: "square", style: `--c:var(${part.variable})`, "aria-hidden": "true" }),
          part.label,
        ),
      ),
    ),
  );
  return {
    node,
    update(state) {
      const rows = rowsOf(model, spec, state);
      picture.replaceChildren(draw(picture, rows, spec, model, store));
      behind.replaceChildren(numbers(rows, spec, model));
    },
  };
}

function rowsOf(model, spec, state) {
  const filter = spec.ofAll ? { site: state.site, outcome: "all" } : state;
  const all = state.site === "all" && (spec.ofAll || state.outcome === "all");
  return model.chosen(state).flatMap((arm) => {
    const whisker = model.cell(arm, spec.whisker, filter);
    if (!whisker) return [];
    const parts = spec.parts.map((part) => {
      const cell = model.cell(arm, part.metric, filter);
      return {
        part,
        cell,
        size: Math.max(0, value(cell) - (part.minus ? value(model.cell(arm, part.minus, filter)) : 0)),
      };
    });
    return [
      {
        arm,
        parts,
        whisker,
        faint: spec.ofAll && state.outcome !== "all" ? state.outcome : null,
        paper: all ? arm.paper[spec.whisker] : null,
      },
    ];
  });
}

function draw(place, rows, spec, model, store) {
  const ground = canvas(place, {
    height: rows.length * ROW + MARGIN.top + MARGIN.bottom,
    label: spec.title,
    margin: { ...MARGIN, left: labelWidth(rows) },
  });
  const longest = Math.max(
    1,
    ...rows.flatMap((row) => [
      row.whisker.hi ?? 0,
      row.paper?.value ?? 0,
      row.parts.reduce((sum, p) => sum + p.size, 0),
    ]),
  );
  const x = scaleLinear([0, spec.full ?? longest * 1.03], [0, ground.width]);
  axes(ground, x, null, { x: spec.axis }, { x: Math.max(3, ground.width / 70) });
  rows.forEach((row, i) => ground.inner.append(drawRow(row, i * ROW, x, spec, model, store)));
  return ground.root;
}

function drawRow(row, top, x, spec, model, store) {
  const group = svg("g", {
    role: "img",
    "aria-label": `${row.arm.label}: ${row.parts.map(({ part, size }) => `${part.label} ${size.toFixed(2)}`).join(", ")}`,
  });
  let from = 0;
  for (const { part, cell, size } of row.parts) {
    const rect = svg("rect", {
      class: row.faint && row.faint !== part.choose ? "bar faint" : "bar",
      style: `--c:var(${part.variable})`,
      x: x(from),
      width: Math.max(0, x(from + size) - x(from)),
      y: top + 4,
      height: ROW - 10,
      onclick: () => (part.choose ? store.toggle("outcome", part.choose) : store.toggleArm(row.arm.key)),
    });
    from += size;
    group.append(
      withTooltip(rect, () => [
        `${row.arm.label}: ${part.label}`,
        part.minus ? `${size.toFixed(2)} %` : withInterval(cell, model.byName[part.metric]),
        row.paper &&
          `paper's ${model.byName[spec.whisker].label}: ${row.paper.text} ${model.byName[spec.whisker].unit}`,
      ]),
    );
  }
  const middle = top + ROW / 2 - 1;
  if (row.whisker.lo !== null)
    group.append(
      svg("line", {
        class: "whisker",
        x1: x(row.whisker.lo),
        x2: x(Math.min(row.whisker.hi, x.domain()[1])),
        y1: middle,
        y2: middle,
      }),
    );
  if (row.paper)
    group.append(
      svg("path", { class: "diamond", d: `M${x(row.paper.value)},${middle - 6}l5,6l-5,6l-5,-6z` }),
    );
  group.append(
    svg(
      "text",
      { class: "row-label", style: `--c:${row.arm.colour}`, x: -10, y: middle + 5, "text-anchor": "end" },
      row.arm.label,
    ),
  );
  return group;
}

const numbers = (rows, spec, model) =>
  tableBehind(
    [
      { label: "arm", text: (r) => r.arm.label, key: (r) => r.arm.label, left: true },
      ...spec.parts.map((part, i) => ({
        label: part.label,
        text: (r) =>
          part.minus ? r.parts[i].size.toFixed(2) : withInterval(r.parts[i].cell, model.byName[part.metric]),
        key: (r) => r.parts[i].size,
      })),
    ],
    rows,
    spec.title,
  );
