import "../report.css";
import { el } from "../lib/dom.js";
import { armRules } from "../lib/palette.js";
import { makeStore, parseFragment, writeFragment } from "../lib/state.js";
import { installTooltip } from "../lib/tooltip.js";
import { decisions, energyParts, outcomes } from "./bars.js";
import { claims } from "./claims.js";
import { convergence } from "./convergence.js";
import { distributions } from "./distributions.js";
import { failures } from "./failures.js";
import { filterBar } from "./filterbar.js";
import { headline } from "./headline.js";
import { missionCloud } from "./missions.js";
import { makeModel } from "./model.js";
import { plane } from "./plane.js";
import { whatWasRun } from "./run.js";
import { sites } from "./sites.js";
import { figuresForPapers, tables } from "./tables.js";

const model = makeModel(JSON.parse(document.getElementById("page-data").textContent));
document.head.append(el("style", {}, armRules(model.arms.map((arm) => arm.name))));
installTooltip();

const allowed = {
  arm: (key) => model.flown.some((arm) => arm.key === key),
  site: (site) => `${site}|all` in model.data.slices,
  outcome: (outcome) => ["all", "0", "1", "2"].includes(outcome),
  theme: (theme) => ["auto", "light", "dark"].includes(theme),
};
const read = () => {
  const state = parseFragment(location.hash, {
    ...allowed,
    site: (site) => allowed.site(model.siteFromAddress(site)),
  });
  return { ...state, site: model.siteFromAddress(state.site) };
};
const store = makeStore(read(), (state) =>
  history.replaceState(null, "", `#${writeFragment({ ...state, site: model.siteToAddress(state.site) })}`),
);

const bar = filterBar(model, store);
const first = headline(model, store);
const pictures =
  model.shown.length === 0
    ? []
    : [
        plane(model, store),
        distributions(model, store),
        energyParts(model, store),
        outcomes(model, store),
        decisions(model, store),
        missionCloud(model, store),
        sites(model, store),
        convergence(model, store),
      ];
const lists = [claims(model, store), model.shown.length > 0 && failures(model, store)].filter(Boolean);
const views = [bar, first, ...pictures, ...lists];

const links = [
  ["headline", "Results"],
  pictures.length > 0 && ["pictures", "Pictures"],
  pictures.length > 0 && ["sites", "Sites"],
  ...lists.map((view) => [view.node.id, view.title]),
  ["tables", model.data.compared ? "Differences" : "Tables"],
  ["run", "What was run"],
].filter(Boolean);
const nav = el(
  "nav",
  { "aria-label": "Sections" },
  links.map(([id, label]) => el("button", { type: "button", class: "link", onclick: () => go(id) }, label)),
);

// The fragment holds the state, so that sections are reached without it.
function go(id) {
  const place = document.getElementById(id);
  place.scrollIntoView({
    behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth",
  });
  place.setAttribute("tabindex", "-1");
  place.focus({ preventScroll: true });
}

document.getElementById("app").append(
  el("header", {}, el("div", { class: "brand" }, "ED³R", el("span", {}, " report")), nav, bar.tools),
  bar.node,
  el(
    "main",
    {},
    first.node,
    pictures.length > 0 &&
      el(
        "section",
        { id: "pictures" },
        el("h2", { class: "hidden" }, "Pictures"),
        el(
          "div",
          { class: "pictures" },
          pictures.map((view) => view.node),
        ),
      ),
    lists.map((view) => view.node),
    tables(model),
    figuresForPapers(model),
    whatWasRun(model),
  ),
);

function update(state) {
  document.documentElement.style.colorScheme = state.theme === "auto" ? "light dark" : state.theme;
  for (const view of views) view.update(state);
}

store.listen(update);
addEventListener("hashchange", () => store.set(read()));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => update(store.get()));
let width = window.innerWidth;
addEventListener("resize", () => {
  if (window.innerWidth === width) return;
  width = window.innerWidth;
  update(store.get());
});
update(store.get());
document.documentElement.dataset.ready = "yes";
