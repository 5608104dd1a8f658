// The ground of a chart: an SVG as wide as its place, margins, axes.
import { axisBottom, axisLeft } from "d3-axis";
import { select } from "d3-selection";
import { el, svg } from "./dom.js";

/** A figure with a heading, a place for the picture, a caption and, behind it, its numbers. */
export function figure(id, title, caption) {
  const controls = el("div", { class: "controls" });
  const picture = el("div", { class: "picture" });
  const behind = el("div");
  const told = el("figcaption", {}, caption);
  const heading = el("h3", { id: `${id}-title` }, title);
  const node = el(
    "figure",
    { id, "aria-labelledby": `${id}-title` },
    el("div", { class: "figure-head" }, heading, controls),
    picture,
    told,
    behind,
  );
  return { node, picture, controls, behind, told, heading };
}

/** {root, inner, width, height} of the plotting area. */
export function canvas(place, { height, label, margin }) {
  const full = Math.max(place.clientWidth, 260);
  const inner = svg("g", { transform: `translate(${margin.left},${margin.top})` });
  const root = svg(
    "svg",
    { viewBox: `0 0 ${full} ${height}`, width: full, height, role: "group", "aria-label": label },
    inner,
  );
  return {
    root,
    inner,
    width: full - margin.left - margin.right,
    height: height - margin.top - margin.bottom,
  };
}

/** 1, 2 and 5 times powers of ten within a logarithmic scale, and its ends where there is room for them. */
export function logTicks(scale, gap_px = 26) {
  const [low, high] = scale.domain();
  const round = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); ++power)
    for (const step of [1, 2, 5]) {
      const value = Number((step * 10 ** power).toPrecision(1));
      if (value >= low && value <= high) round.push(value);
    }
  return withEnds(round, scale, gap_px);
}

/** Round ticks with the ends of the scale; of two that are too near to one another the end is kept. */
export function withEnds(ticks, scale, gap_px = 26) {
  const ends = scale.domain();
  const free = ticks.filter((tick) => ends.every((end) => Math.abs(scale(tick) - scale(end)) >= gap_px));
  return [ends[0], ...free, ends[1]];
}

const ticked = (axis, count, values, format) =>
  values ? axis.tickValues(values).tickFormat(format) : axis.ticks(count, format);

/** Axes at the left and below, with what they count. `ticks`: a count and a format of each axis, or the values themselves. */
export function axes(ground, x, y, labels, ticks = {}) {
  const { inner, width, height } = ground;
  if (x) {
    const axis = svg("g", { class: "axis", transform: `translate(0,${height})`, "aria-hidden": "true" });
    select(axis).call(
      ticked(axisBottom(x), ticks.x ?? Math.max(3, width / 90), ticks.xValues, ticks.xFormat).tickSizeOuter(
        0,
      ),
    );
    inner.append(
      axis,
      svg("text", { class: "axis-label", x: width, y: height + 36, "text-anchor": "end" }, labels.x),
    );
  }
  if (y) {
    const axis = svg("g", { class: "axis grid", "aria-hidden": "true" });
    select(axis).call(ticked(axisLeft(y), ticks.y ?? 5, ticks.yValues, ticks.yFormat).tickSize(-width));
    inner.append(axis, svg("text", { class: "axis-label", x: -8, y: -12, "text-anchor": "start" }, labels.y));
  }
}

/** Room for the names beside the rows of a picture. */
export const labelWidth = (rows) =>
  Math.min(190, 18 + 7.9 * Math.max(8, ...rows.map((row) => row.arm.label.length)));
