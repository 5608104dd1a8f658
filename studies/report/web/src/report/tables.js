// Every table of the report, sortable, with links to its files; what variants change; the static figures.
import { el } from "../lib/dom.js";
import { count, interval, number, pValue } from "../lib/format.js";
import { sortedTable } from "../lib/table.js";

export function tables(model) {
  const { data } = model;
  if (data.compared) return compared(model);
  return el(
    "section",
    { id: "tables" },
    el("h2", {}, "Tables"),
    el(
      "p",
      { class: "key" },
      "Ours in bold, the 95 % interval beneath, then the paper's value (◆: our interval holds it, give or take its rounding). These are of all missions, whatever is chosen above.",
    ),
    data.tables.map((table) => tableNode(model, table)),
    differences(model),
    variants(model),
    el(
      "p",
      { class: "files" },
      "Every metric of every arm: ",
      [
        "report.txt",
        "report.json",
        "metrics.csv",
        "generalisation.csv",
        "convergence.csv",
        "look_forward.csv",
      ].map((file) => [el("a", { href: file }, file), " "]),
      "made by ",
      el("code", {}, data.run.report_command),
    ),
  );
}

function tableNode(model, table) {
  const metrics = table.metrics.map((index) => model.metrics[index]);
  const cellNode = ([value, lo, hi, paper], metric) => [
    el("b", {}, number(value, metric.decimals)),
    el("i", {}, interval(lo, hi, metric.decimals)),
    paper &&
      el(
        "span",
        { class: paper.within ? "paper within" : "paper" },
        `${paper.within ? "◆" : "◇"} ${paper.text}`,
      ),
  ];
  const columns = table.arms_down
    ? [
        {
          label: "arm",
          left: true,
          key: (i) => table.labels[i],
          text: (i) => [table.labels[i], " ", el("small", {}, count(table.missions[i]))],
        },
        ...metrics.map((metric, m) => ({
          label: metric.heading,
          key: (i) => table.cells[i][m][0],
          text: (i) => cellNode(table.cells[i][m], metric),
        })),
      ]
    : [
        { label: "", left: true, key: (m) => metrics[m].heading, text: (m) => metrics[m].heading },
        ...table.labels.map((label, i) => ({ label, text: (m) => cellNode(table.cells[i][m], metrics[m]) })),
      ];
  const rows = (table.arms_down ? table.labels : metrics).map((_, i) => i);
  return el(
    "details",
    { open: table.id === "arms" ? undefined : true, id: `table-${table.id}` },
    el("summary", {}, el("h3", {}, table.title)),
    sortedTable(columns, rows, { caption: table.title }),
    table.note && el("p", { class: "key" }, table.note),
    el(
      "p",
      { class: "files" },
      ["md", "tex", "csv", "json"].map((ending) => [
        el("a", { href: `tables/${table.id}.${ending}` }, `${table.id}.${ending}`),
        " ",
      ]),
    ),
  );
}

/** Of runs that are compared: their own reports have the tables. */
const compared = (model) =>
  el(
    "section",
    { id: "tables" },
    el("h2", {}, "Differences"),
    variants(model),
    el(
      "p",
      { class: "files" },
      ["compare.txt", "differences.csv", "verdicts.csv", "manifest.json"].map((file) => [
        el("a", { href: file }, file),
        " ",
      ]),
      "made by ",
      el("code", {}, model.data.run.report_command),
    ),
  );

const differenceCell = (row) => [
  el(row.certain ? "b" : "span", {}, `${row.difference > 0 ? "+" : ""}${number(row.difference, 2)}`),
  el("i", {}, interval(row.lo, row.hi, 2)),
];

/** Arms of a stage minus one of them, where no claims of the paper compare them. */
function differences(model) {
  const rows = model.data.differences;
  const notes = (model.data.difference_notes ?? []).map((note) => el("p", {}, note));
  if (!rows || rows.length === 0) return notes.length > 0 ? notes : null;
  const heading = (row) => model.byName[row.metric]?.heading ?? row.metric;
  return [
    el("h3", { id: "differences" }, "Arms compared"),
    el(
      "p",
      { class: "key" },
      "Each arm minus another of its stage, paired by scenario, with 95 % intervals; p after Holm’s correction for all of them, bold below 0.05 unless a single trained network flew on a side.",
    ),
    sortedTable(
      [
        { label: "arm", left: true, key: (r) => r.arm, text: (r) => r.arm },
        { label: "minus", left: true, key: (r) => r.minus, text: (r) => r.minus },
        { label: "metric", left: true, key: heading, text: heading },
        { label: "difference", key: (r) => r.difference, text: differenceCell },
        { label: "p", key: (r) => r.p_holm, text: (r) => pValue(r.p_holm) },
        { label: "pairs", key: (r) => r.pairs, text: (r) => count(r.pairs) },
      ],
      rows,
      { caption: "Arms compared" },
    ),
    ...notes,
    el("p", { class: "files" }, el("a", { href: "differences.csv" }, "differences.csv")),
  ];
}

function variants(model) {
  const study = model.data.variants;
  if (!study) return null;
  const metric = (row) => model.byName[row.metric];
  return [
    el("h3", {}, `What each variant changes, compared with “${study.base}”`),
    el(
      "p",
      { class: "key" },
      "Each variant minus the first, paired by scenario, with 95 % intervals; bold where the interval does not hold 0." +
        (model.data.compared
          ? ""
          : " Pictures and other tables on this page are of one variant, which the first lines name."),
    ),
    sortedTable(
      [
        { label: "variant", left: true, key: (r) => r.variant, text: (r) => r.variant },
        { label: "arm", left: true, key: (r) => r.label, text: (r) => r.label },
        { label: "metric", left: true, key: (r) => r.metric, text: (r) => metric(r)?.heading ?? r.metric },
        { label: "difference", key: (r) => r.difference, text: differenceCell },
      ],
      study.differences,
      { caption: "What each variant changes" },
    ),
    ...(model.data.variant_notes ?? []).map((note) => el("p", {}, note)),
    !model.data.compared &&
      el(
        "p",
        { class: "files" },
        el("a", { href: "variants.csv" }, "variants.csv"),
        " ",
        el("a", { href: "variant_verdicts.csv" }, "variant_verdicts.csv"),
      ),
  ];
}

export function figuresForPapers(model) {
  const { figures, run } = model.data;
  if (figures.length === 0) return null;
  return el(
    "section",
    { id: "figures" },
    el("h2", {}, "Figures for papers"),
    run.figures_note && el("p", { class: "note" }, run.figures_note),
    el(
      "p",
      { class: "key" },
      "Still pictures beside this page, with their captions in ",
      el("a", { href: "figures/README.md" }, "figures/README.md"),
      "; their data: ",
      el("a", { href: "figures/data.json" }, "figures/data.json"),
      "; redrawn with ",
      el("code", {}, "scripts/plot.py FOLDER"),
      ", FOLDER holding data.json.",
    ),
    el(
      "ol",
      { class: "figures" },
      figures.map((figure) =>
        el(
          "li",
          {},
          el("details", {}, el("summary", {}, figure.title), el("p", {}, figure.caption)),
          !run.figures_note && [
            el("a", { href: `figures/${figure.id}.svg` }, "svg"),
            " ",
            el("a", { href: `figures/${figure.id}.png` }, "png"),
          ],
        ),
      ),
    ),
  );
}
