// The paper's claims and what became of them, filtered by verdict, arm, metric and certainty.
import { el } from "../lib/dom.js";
import { interval, number, plural, pValue } from "../lib/format.js";
import { sortedTable } from "../lib/table.js";
import { select } from "./filterbar.js";

const CERTAINTY = [
  ["all", "all"],
  ["p001", "p < 0.001"],
  ["p05", "p < 0.05"],
  ["open", "p ≥ 0.05"],
  ["none", "no p value"],
];

/** The smaller of the two p values: for the claim, or for its opposite. */
const decisive = (claim) => {
  const both = [claim.p, claim.p_against].filter((p) => p !== null);
  return both.length > 0 ? Math.min(...both) : null;
};

export function certaintyOf(claim) {
  const p = decisive(claim);
  return p === null ? ["none"] : p < 0.001 ? ["p001", "p05"] : p < 0.05 ? ["p05"] : ["open"];
}

/** Every word of `find` stands somewhere in what the claim's row tells. */
const holds = (claim, find, spoken) => {
  const text = [
    spoken(claim),
    claim.id,
    claim.words,
    claim.claim,
    claim.where,
    claim.metric,
    claim.told,
    claim.why,
  ]
    .join(" ")
    .toLowerCase();
  return find
    .toLowerCase()
    .split(/\s+/)
    .every((word) => text.includes(word));
};

/** Claims that pass the filters; `names` are the arms chosen, none: all. */
export const filterClaims = (claims, { verdict, about, sure, find = "" }, names, spoken = () => "") =>
  claims.filter(
    (claim) =>
      holds(claim, find, spoken) &&
      (verdict === "all" || claim.verdict === verdict) &&
      (about === "all" || claim.metric === about) &&
      (sure === "all" || certaintyOf(claim).includes(sure)) &&
      (names.length === 0 || claim.arms.split(" ").some((arm) => names.includes(arm.replace(/-p85$/, "")))),
  );

/** Those of the abstract first, else in the order of the paper. */
export const abstractFirst = (claims) => [
  ...claims.filter((claim) => claim.where === "Abstract"),
  ...claims.filter((claim) => claim.where !== "Abstract"),
];

const NETWORKS = { "rc-rfnn": "the controller's network", "robot-rfnn": "the robot's network" };
const escaped = (text) => text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");

/** Names of arms and of the claim's metric as the tables have them, in place of the engine's. */
export function inWords(text, claim, model) {
  const names = { ...NETWORKS };
  for (const arm of model.arms) {
    names[arm.name] = arm.label;
    names[`${arm.name}-p85`] = `P85 of ${arm.label}`;
  }
  const studied = model.arms.find((arm) => arm.name === "ed3r-75");
  if (studied) names["ed3r-p85"] = `P85 of ${studied.label}`; // as the paper calls it
  const list = Object.keys(names)
    .sort((a, b) => b.length - a.length)
    .map(escaped);
  const metric = model.byName[claim.metric];
  const short = claim.metric.replace(/_(pct|kj|min)$/, "").replaceAll("_", " ");
  return text
    .replace(/ - /g, " − ")
    .replace(/(?<![\w.])-(?=\d)/g, "−")
    .replace(/\bablation-(\d)\.\.(\d)/g, "Ablations $1 to $2")
    .replace(new RegExp(`(?<![\\w-])(${list.join("|")})(?![\\w-])`, "g"), (name) => names[name])
    .replace(
      new RegExp(`\\b${escaped(short)}\\b`),
      metric ? metric.heading.replace(/, (\S+)$/, " ($1)") : short,
    );
}

/** What is claimed: the paper's words where ours would be a formula. */
export const saying = (claim, words = (text) => text) =>
  claim.words && /[*/]|max\(|min\(/.test(claim.claim)
    ? { main: `“${claim.words}”`, small: `${words(claim.claim)} (${claim.where})` }
    : { main: words(claim.claim), small: `“${claim.words}” (${claim.where})` };

export function claims(model, store) {
  const { claims: study, run } = model.data;
  const judged = abstractFirst(study.list.filter((claim) => claim.verdict !== "not measured"));
  if (judged.length === 0) return null;
  const built = study.by_construction ?? 0;
  const different = study.counts.reduce((sum, [verdict, n]) => sum + (verdict === "not measured" ? 0 : n), 0);
  const chips = study.counts
    .filter(([verdict]) => verdict !== "not measured")
    .map(([verdict, n]) =>
      el(
        "button",
        {
          type: "button",
          class: `chip verdict ${classOf(verdict)}`,
          "data-verdict": verdict,
          onclick: () => store.toggle("verdict", verdict),
        },
        el("b", {}, verdict === "reproduced" ? n - built : n),
        ` ${verdict}`,
        verdict === "reproduced" && built > 0 && ` + ${built} by construction`,
      ),
    );
  const metrics = [...new Set(judged.map((claim) => claim.metric))].sort();
  const about = select(
    "Metric",
    [["all", "all"], ...metrics.map((m) => [m, model.byName[m]?.label ?? m.replaceAll("_", " ")])],
    (value) => store.set({ about: value }),
  );
  const sure = select("Certainty", CERTAINTY, (value) => store.set({ sure: value }));
  const search = el("input", {
    type: "search",
    oninput: () => store.set({ find: search.value.trim() }),
  });
  const unmeasured = study.counts.find(([verdict]) => verdict === "not measured")?.[1] ?? 0;
  const shown = el("p", { class: "key", "aria-live": "polite" });
  const list = el("div");
  const node = el(
    "section",
    { id: "claims" },
    el("h2", {}, "The paper's claims"),
    model.data.compared && el("p", { class: "note" }, `Judged by ${model.data.compared[0]} alone.`),
    el("div", { class: "chips" }, chips),
    el("p", { class: "key" }, study.correction),
    study.p85_note && el("p", { class: "key" }, study.p85_note),
    el(
      "details",
      { class: "key" },
      el("summary", {}, "What the verdicts mean"),
      el("p", {}, study.rules),
      el("p", {}, study.luck),
      built > 0 &&
        el(
          "p",
          {},
          `${plural(built, "claim holds", "claims hold")} by construction: how the study is set up or an arm is built, no finding.`,
        ),
    ),
    el("div", { class: "choices" }, about.node, sure.node, el("label", { class: "choice" }, "Text ", search)),
    shown,
    list,
    el(
      "p",
      { class: "key" },
      `Orders and comparisons are paired by scenario (${study.scenarios} of them) and resampled over ${study.networks > 1 ? `${study.networks} trained networks and missions` : "missions"}; with ! the claim points the other way. ` +
        "“one network”: how many of the networks, each with its own missions alone, would have given the verdict; empty where these are too few. " +
        `${unmeasured} claims are not measured by this run. All of it: `,
      el("a", { href: "verdicts.csv" }, "verdicts.csv"),
      study.networks > 1 && [", ", el("a", { href: "by_network.csv" }, "by_network.csv")],
      run.figures_note && "",
    ),
  );
  return {
    node,
    title: "Claims",
    update(state) {
      for (const chip of chips)
        chip.setAttribute("aria-pressed", String(chip.dataset.verdict === state.verdict));
      about.input.value = state.about;
      sure.input.value = state.sure;
      if (search.value.trim() !== state.find) search.value = state.find;
      const names = state.arms.map((key) => model.arms.find((arm) => arm.key === key)?.name);
      const found = filterClaims(judged, state, names, (c) => inWords(c.claim, c, model));
      shown.textContent = `${found.length} of ${judged.length} rows, ${different} different claims (the paper makes some several times)${names.length > 0 ? ", those that speak of the arms chosen" : ""}.`;
      list.replaceChildren(
        sortedTable(columns(model, study), found, { caption: "Claims of the paper and their verdicts" }),
      );
    },
  };
}

const classOf = (verdict) => `v-${verdict.split(" ")[0]}`;

const columns = (model, study) => [
  { label: "claim", text: (c) => c.id, key: (c) => c.id, left: true },
  {
    label: "says",
    left: true,
    key: (c) => c.claim,
    text: (c) => {
      const words = (text) => inWords(text, c, model);
      const { main, small } = saying(c, words);
      return el(
        "div",
        { class: "says" },
        main,
        el("small", {}, small),
        el(
          "small",
          { class: "why" },
          words(c.why),
          c.repeats && ` · says the same as ${c.repeats}`,
          c.p85 && study.p85_note && " · of P85 see the note above the list",
        ),
      );
    },
  },
  { label: "paper", text: (c) => (c.paper === null ? "" : number(c.paper, 2)), key: (c) => c.paper },
  {
    label: "ours, 95 %",
    text: (c) => [number(c.ours, 2), el("i", {}, interval(c.lo, c.hi, 2))].map((part) => part),
    key: (c) => c.ours,
  },
  {
    label: "p",
    title: "Corrected for all claims (Holm); with ! the claim points the other way",
    text: (c) => (decisive(c) === null ? "" : pValue(decisive(c)) + (c.other_way ? "!" : "")),
    key: decisive,
  },
  ...(study.networks > 1
    ? [
        {
          label: "one network",
          title:
            "How many of the trained networks, each with its own missions alone, would have given this verdict; a few missions decide less than all. Empty: too few.",
          text: (c) => (c.networks ? `${c.networks[0]} of ${c.networks[1]}` : ""),
          key: (c) => c.networks?.[0],
        },
      ]
    : []),
  {
    label: "verdict",
    left: true,
    text: (c) => [
      el("span", { class: `verdict ${classOf(c.verdict)}` }, c.told, c.built && ", by construction"),
      c.other_way && el("small", { class: "why" }, " points the other way"),
    ],
    key: (c) => c.told,
  },
];
