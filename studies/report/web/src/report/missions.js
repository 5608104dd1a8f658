// Every mission as a point: energy against the confidence of its reliable looks, or its duration. Drawn on a canvas; the
// list of failed missions is the way there without a pointer.
import { scaleLinear } from "d3-scale";
import { axes, canvas, figure } from "../lib/chart.js";
import { button, copyText, el } from "../lib/dom.js";
import { count, number } from "../lib/format.js";
import { OUTCOMES } from "../lib/palette.js";
import { tableBehind } from "../lib/table.js";
import { hideTooltip, showTooltip } from "../lib/tooltip.js";
import { outcomeLegend } from "./distributions.js";

const MARGIN = { top: 26, right: 18, bottom: 46, left: 46 };
const HEIGHT = 380;
const NEAR = 14;
const LISTED = 100;

export function missionCloud(model, store) {
  const { node, picture, controls, behind } = figure(
    "missions",
    "Every mission",
    "Energy of a mission against the mean confidence of its reliable looks; missions without one lie on the line at the bottom. " +
      "A click on a point gives the command that flies it again.",
  );
  controls.append(outcomeLegend(store));
  const picked = el("p", { class: "picked", "aria-live": "polite" });
  picture.after(picked);
  return {
    node,
    redrawOnTheme: true,
    update(state) {
      const points = pointsOf(model, state);
      const drawing = draw(picture, points);
      picture.replaceChildren(drawing.node);
      picked.replaceChildren(thinned(model, state));
      drawing.onPick((point) => picked.replaceChildren(...pickedText(model, point)));
      behind.replaceChildren(numbers(points));
    },
  };
}

function pointsOf(model, state) {
  const points = [];
  for (const arm of model.chosen(state)) {
    const columns = model.data.points[arm.index];
    columns.number.forEach((n, i) => {
      const site = columns.site[i],
        outcome = columns.outcome[i];
      if (!model.atSite(state, site) || (state.outcome !== "all" && state.outcome !== String(outcome)))
        return;
      points.push({
        arm,
        number: n,
        site,
        outcome,
        energy: columns.energy_kj[i],
        duration: columns.duration_min[i],
        scs: columns.scs_pct[i],
        siteName: model.sites.get(site)?.name,
      });
    });
  }
  return points;
}

function thinned(model, state) {
  const every = Math.max(...model.chosen(state).map((arm) => model.data.points[arm.index].every));
  return every > 1 ? `Of the largest arms every ${every}th mission is drawn.` : "";
}

function draw(place, points) {
  const ground = canvas(place, { height: HEIGHT, label: "Missions as points", margin: MARGIN });
  ground.root.setAttribute("aria-hidden", "true");
  const scores = points.map((p) => p.scs).filter((s) => s !== null);
  const low = scores.length > 0 ? Math.floor(Math.min(...scores) / 5) * 5 : 0;
  const x = scaleLinear([0, Math.max(1, ...points.map((p) => p.energy)) * 1.02], [0, ground.width]);
  const y = scaleLinear([low - 3, 100], [ground.height, 0]);
  axes(ground, x, y, { x: "energy of a mission, kJ", y: "mean confidence of reliable looks, %" });
  const style = getComputedStyle(document.documentElement);
  const colours = OUTCOMES.map((o) => style.getPropertyValue(o.variable).trim());
  const cloud = el("canvas", {
    class: "cloud",
    role: "img",
    "aria-label": `${points.length} missions as points`,
  });
  const ratio = window.devicePixelRatio || 1;
  const full = ground.width + MARGIN.left + MARGIN.right;
  cloud.width = full * ratio;
  cloud.height = HEIGHT * ratio;
  cloud.style.width = `${full}px`;
  const probe = resolved(colours, place);
  const pen = cloud.getContext("2d");
  pen.scale(ratio, ratio);
  pen.translate(MARGIN.left, MARGIN.top);
  pen.globalAlpha = points.length > 3000 ? 0.45 : 0.7;
  for (const p of points) {
    p.x = x(p.energy);
    p.y = y(p.scs ?? low - 2.2);
    pen.fillStyle = probe[p.outcome];
    stamp(pen, p);
  }
  const node = el("div", { class: "stack" }, ground.root, cloud);
  return { node, onPick: (pick) => listen(cloud, points, pick) };
}

/** What the style's colours are in the theme of the day: a canvas knows no light-dark(). */
function resolved(colours, place) {
  return colours.map((colour) => {
    const probe = el("span", { style: `color:${colour}` });
    place.append(probe);
    const found = getComputedStyle(probe).color;
    probe.remove();
    return found;
  });
}

// A shape for each outcome, as in the static figures.
function stamp(pen, p) {
  pen.beginPath();
  if (p.outcome === 0) pen.arc(p.x, p.y, 2.6, 0, 2 * Math.PI);
  else if (p.outcome === 1) {
    pen.moveTo(p.x, p.y - 4.4);
    pen.lineTo(p.x + 4, p.y + 3);
    pen.lineTo(p.x - 4, p.y + 3);
  } else pen.rect(p.x - 3, p.y - 3, 6, 6);
  pen.fill();
}

function listen(cloud, points, pick) {
  const nearest = (event) => {
    const place = cloud.getBoundingClientRect();
    const x = event.clientX - place.left - MARGIN.left,
      y = event.clientY - place.top - MARGIN.top;
    let best = null,
      distance = NEAR * NEAR;
    for (const p of points) {
      const d = (p.x - x) ** 2 + (p.y - y) ** 2;
      if (d < distance) [best, distance] = [p, d];
    }
    return best;
  };
  cloud.addEventListener("pointermove", (event) => {
    const point = nearest(event);
    if (point) showTooltip(lines(point), event.clientX, event.clientY);
    else hideTooltip();
  });
  cloud.addEventListener("pointerleave", hideTooltip);
  cloud.addEventListener("click", (event) => {
    const point = nearest(event);
    if (point) pick(point);
  });
}

const lines = (p) => [
  `${p.arm.label}, mission ${p.number}: ${OUTCOMES[p.outcome].label}`,
  `${number(p.energy, 2)} kJ in ${number(p.duration, 2)} min`,
  p.scs === null ? "no reliable look" : `confidence ${number(p.scs, 1)} %`,
  p.siteName,
];

export function pickedText(model, point) {
  const command = model.command(point.arm, point.number);
  const copy = button("Copy", () => copyText(command, copy), { class: "small" });
  return [el("strong", {}, lines(point).join(" · ")), " ", el("code", {}, command), " ", copy];
}

const numbers = (points) =>
  tableBehind(
    [
      { label: "mission", text: (p) => `${p.arm.label} ${p.number}`, key: (p) => p.number, left: true },
      { label: "ended", text: (p) => OUTCOMES[p.outcome].label, key: (p) => p.outcome, left: true },
      { label: "site", text: (p) => p.siteName, key: (p) => p.siteName, left: true },
      { label: "energy, kJ", text: (p) => number(p.energy, 2), key: (p) => p.energy },
      { label: "duration, min", text: (p) => number(p.duration, 2), key: (p) => p.duration },
      { label: "confidence, %", text: (p) => number(p.scs, 1), key: (p) => p.scs },
    ],
    [...points].sort((a, b) => b.energy - a.energy).slice(0, LISTED),
    points.length > LISTED ? `The ${LISTED} dearest of ${count(points.length)} missions` : "Missions",
  );
