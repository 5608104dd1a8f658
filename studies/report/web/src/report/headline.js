// The first screen: the study's question, the answer, the main metrics beside the paper's.
import { scaleLinear } from "d3-scale";
import { el, svg } from "../lib/dom.js";
import { count, interval, number, plural, withInterval } from "../lib/format.js";
import { OUTCOMES } from "../lib/palette.js";
import { order } from "../lib/table.js";
import { withTooltip } from "../lib/tooltip.js";

const MAIN = ["total_energy_kj", "msr_pct", "duration_mean_min", "fp_pct", "bd_pct", "wer_pct", "mscs_pct"];

// Each of them is given where one outcome is chosen.
const BY_OUTCOME = ["msr_pct", "fp_pct", "bd_pct", "wer_pct"];

const TASK =
  "A robot looks for a wildfire in a forest: it flies a short way, looks with its camera, and a detector scores the look (SCS, 0 to 100 %). " +
  "A mission ends when enough looks in a row score above a threshold – in success where it was the fire, in a false alarm where it was not – or when the battery is empty. " +
  "An arm is one way to decide where to fly and where to process a look.";

const ABBREVIATIONS =
  "Means of a mission's energy and duration. MSR: missions that ended in success. FP: in a false alarm. BD: with an empty battery. " +
  "WER: share of all energy that failed missions took. MSCS: mean confidence of reliable looks.";

export function headline(model, store) {
  const { data } = model;
  const text = el(
    "div",
    { class: "lead" },
    el("p", { class: "kicker" }, `${data.name} · ${told(data)}`),
    el("h1", {}, data.question || data.name),
    el("p", { class: "task" }, TASK),
    news(model),
    el("p", { class: "answer" }, answerOf(data)),
    armsTold(model),
    data.run_letters &&
      el(
        "p",
        { class: "key letters" },
        data.run_letters.map(({ letter, run }) => el("span", {}, el("b", {}, letter), ` ${run}`)),
      ),
    data.departures.map((note) => el("p", { class: "note" }, note)),
  );
  const table = el("div", {
    class: "wide",
    tabindex: 0,
    role: "region",
    "aria-label": "Main results beside the paper's",
  });
  const note = el("p", { class: "key" });
  const selection = el("p", { class: "note", role: "status", hidden: true });
  const node = el(
    "section",
    { id: "headline", "aria-label": "What came out" },
    text,
    model.shown.length > 0 && [selection, table, note],
  );
  return {
    node,
    title: "Results",
    update(state) {
      if (model.shown.length === 0) return;
      table.replaceChildren(headTable(model, store, state));
      note.replaceChildren(...key(state, model));
      selection.hidden = !filtered(state);
      selection.textContent = selectionWords(model, state);
    },
  };
}

/** The studied arm beside the paper's, in what matters most: nothing where the paper did not fly this. */
export function newsOf(model) {
  const arm = model.data.claims.list.length > 0 ? model.arms[model.data.studied] : undefined;
  if (!arm) return [];
  return [
    ["msr_pct", "Missions that find the fire"],
    ["total_energy_kj", "Energy of a mission"],
    ["fp_pct", "False alarms"],
  ].flatMap(([name, what]) => {
    const paper = arm.paper[name];
    const cell = paper && model.cell(arm, name);
    return cell && cell.value !== null ? [{ arm, what, cell, paper, metric: model.byName[name] }] : [];
  });
}

function news(model) {
  const list = newsOf(model);
  if (list.length === 0) return null;
  return el(
    "ul",
    { class: "news", "aria-label": `${list[0].arm.label}: ours beside the paper's` },
    list.map(({ arm, what, cell, paper, metric }) =>
      el(
        "li",
        {},
        el("span", {}, `${what}, ${arm.label}`),
        el("b", {}, `${number(cell.value, 1)} ${metric.unit}`),
        el("span", {}, interval(cell.lo, cell.hi, 1) && `95 % interval ${interval(cell.lo, cell.hi, 1)}`),
        el(
          "span",
          { class: paper.within ? "paper within" : "paper" },
          `${paper.within ? "◆" : "◇"} the paper: ${paper.text} ${metric.unit}${paper.within ? ", within ours" : ", outside ours"}`,
        ),
      ),
    ),
  );
}

/** Only where arms differ in it. */
function threshold(model, arm) {
  const all = new Set(model.flown.map((other) => other.eta_min_pct));
  return all.size > 1 && arm.eta_min_pct !== null
    ? `; sure of a fire from a score of ${arm.eta_min_pct} %`
    : "";
}

function armsTold(model) {
  const told = model.flown.filter((arm) => arm.about && !arm.dir).sort((a, b) => a.warmup - b.warmup);
  if (told.length === 0) return null;
  return el(
    "ul",
    { class: "arms-told", "aria-label": "What the arms are" },
    told.map((arm) =>
      el(
        "li",
        {},
        el("span", { class: "swatch", style: `--c:${arm.colour}`, "aria-hidden": "true" }),
        el("b", {}, ` ${arm.label}`),
        `: ${arm.about}${threshold(model, arm)}`,
      ),
    ),
  );
}

/** What of all missions the table and the pictures show. */
export function selectionWords(model, { site, outcome }) {
  const place =
    { all: "", known: " at the sites known to the warm-up", unseen: " at the sites new to the networks" }[
      site
    ] ?? ` at ${model.sites.get(Number(site))?.name}`;
  const end = OUTCOMES.find((o) => o.id === outcome);
  return `Shown below: missions${place}${end ? ` that ended in: ${end.label}` : ""}. The sentences above, the claims and the tables are of all missions.${
    end ? " What the choice of one outcome fixes (MSR, FP, BD, WER) is left out." : ""
  }`;
}

function answerOf(data) {
  if (data.answer.length > 0) return data.answer.join(" ");
  return data.arms.some((arm) => arm.missions > 0)
    ? "No answer yet: only the warm-up has been flown so far."
    : "No missions yet.";
}

/** "3,920 missions judged, 20,400 to train on". */
export function told(data) {
  const flown = (warmup) =>
    data.arms.reduce((sum, arm) => sum + (Boolean(arm.warmup) === warmup ? arm.missions : 0), 0);
  const judged = flown(false),
    warm = flown(true);
  const networks = Math.max(...data.arms.map((arm) => arm.networks), 0);
  return `${plural(judged, "mission")} judged${warm > 0 ? `, ${count(warm)} to train on` : ""}${networks > 1 ? `, ${networks} trained networks of each kind` : ""}`;
}

const filtered = (state) => state.site !== "all" || state.outcome !== "all";

const key = (state, model) => [
  ABBREVIATIONS,
  el("br"),
  el("b", {}, "Bold"),
  " ours, beneath it the 95 % interval, also drawn on a scale common to the column; ",
  el("span", { class: "paper-mark", "aria-hidden": "true" }, "◇"),
  " the paper's value, ",
  el("span", { class: "within" }, "filled ◆"),
  " where our interval holds it, give or take its rounding. ",
  filtered(state)
    ? "The paper's values are of all missions and are not shown beside a selection."
    : model.data.claims.networks > 1
      ? "Intervals hold the luck of training."
      : "",
];

/** The metrics that say something of the missions chosen. */
export const columnsFor = ({ outcome }) =>
  outcome === "all" ? MAIN : MAIN.filter((name) => !BY_OUTCOME.includes(name));

function headTable(model, store, state) {
  const metrics = columnsFor(state).map((name) => model.byName[name]);
  const arms = sorted(model, state);
  const scales = metrics.map((metric) => columnScale(model, metric, arms, state));
  const choose = (name) => store.set({ sort: state.sort === `-${name}` ? name : `-${name}` });
  const heads = metrics.map((metric) =>
    el(
      "th",
      { scope: "col", "aria-sort": sortOf(state, metric.name), title: metric.label },
      el("button", { type: "button", class: "sort", onclick: () => choose(metric.name) }, metric.heading),
    ),
  );
  return el(
    "table",
    { class: "headline", id: "headline-table" },
    el("caption", { class: "hidden" }, "Main results of each arm beside the paper's"),
    el("thead", {}, el("tr", {}, el("th", { scope: "col", class: "left" }, "arm"), heads)),
    el(
      "tbody",
      {},
      arms.map((arm) =>
        el(
          "tr",
          { "data-arm": arm.key },
          el(
            "th",
            { scope: "row", class: "left" },
            armButton(arm, store, state),
            " ",
            el("small", {}, missionsOf(model, arm, state)),
          ),
          metrics.map((metric, i) => cellOf(model, arm, metric, scales[i], state)),
        ),
      ),
    ),
  );
}

const missionsOf = (model, arm, state) =>
  `${count(model.missions(arm, state))} ${arm.failed ? `(+${count(arm.failed)} broke down) ` : ""}${
    arm.missing ? `(${count(arm.missing)} missing)` : ""
  }`;

const sortOf = (state, name) =>
  state.sort === name ? "ascending" : state.sort === `-${name}` ? "descending" : "none";

function sorted(model, state) {
  const arms = model.chosen(state);
  const name = state.sort.replace(/^-/, "");
  if (!model.byName[name]) return arms;
  const sign = state.sort.startsWith("-") ? -1 : 1;
  const value = (arm) => model.cell(arm, name, state)?.value;
  return [...arms].sort((a, b) => sign * order(value(a), value(b)));
}

const armButton = (arm, store, state) =>
  el(
    "button",
    {
      type: "button",
      class: "arm",
      style: `--c:${arm.colour}`,
      "aria-pressed": String(state.arms.includes(arm.key)),
      title: arm.about || undefined,
      onclick: () => store.toggleArm(arm.key),
    },
    el("span", { class: "swatch", "aria-hidden": "true" }),
    arm.label,
  );

function columnScale(model, metric, arms, state) {
  const ends = [];
  for (const arm of arms) {
    const cell = model.cell(arm, metric.name, state);
    if (cell) ends.push(cell.value, cell.lo, cell.hi);
    if (!filtered(state)) ends.push(arm.paper[metric.name]?.value);
  }
  const real = ends.filter((end) => end !== null && end !== undefined);
  const low = Math.min(...real),
    high = Math.max(...real);
  return scaleLinear([low, high > low ? high : low + 1], [5, 95]);
}

function cellOf(model, arm, metric, scale, state) {
  const cell = model.cell(arm, metric.name, state);
  if (!cell || cell.value === null) return el("td", {}, "–");
  const paper = filtered(state) ? undefined : arm.paper[metric.name];
  const node = el(
    "td",
    { "data-metric": metric.name, "data-value": cell.value },
    el(
      "div",
      { class: "pair" },
      paper
        ? el(
            "span",
            { class: paper.within ? "paper within" : "paper" },
            `${paper.within ? "◆" : "◇"} ${paper.text}`,
          )
        : el("span"),
      el("b", {}, number(cell.value, metric.decimals)),
    ),
    el("i", {}, interval(cell.lo, cell.hi, metric.decimals) || "\u00a0"),
    strip(cell, paper, scale, arm),
  );
  return withTooltip(node, () => [
    `${arm.label}: ${metric.label}`,
    `ours ${withInterval(cell, metric)}`,
    `${count(cell.missions)} missions`,
    paper && `paper ${paper.text} ${metric.unit}${paper.derived ? " (derived, not printed)" : ""}`,
    paper?.elsewhere?.length && `elsewhere in the paper: ${paper.elsewhere.join(", ")}`,
  ]);
}

const strip = (cell, paper, scale, arm) =>
  svg(
    "svg",
    {
      class: "strip",
      viewBox: "0 0 100 10",
      preserveAspectRatio: "none",
      "aria-hidden": "true",
      style: `--c:${arm.colour}`,
    },
    svg("line", { x1: 0, x2: 100, y1: 5, y2: 5, class: "ground" }),
    cell.lo !== null && svg("line", { x1: scale(cell.lo), x2: scale(cell.hi), y1: 5, y2: 5, class: "range" }),
    svg("line", { x1: scale(cell.value), x2: scale(cell.value), y1: 0.5, y2: 9.5, class: "mean" }),
    paper &&
      svg("line", { x1: scale(paper.value), x2: scale(paper.value), y1: 0.5, y2: 9.5, class: "theirs" }),
  );
