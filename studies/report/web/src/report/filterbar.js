// What is chosen, always in sight: arms, site, outcome; and the page's theme.
import { button, copyText, el } from "../lib/dom.js";
import { OUTCOMES } from "../lib/palette.js";
import { START } from "../lib/state.js";

const THEMES = { auto: "Theme: system", light: "Theme: light", dark: "Theme: dark" };

export function filterBar(model, store) {
  const arms = [...model.flown]
    .sort((a, b) => a.warmup - b.warmup)
    .map((arm) =>
      el(
        "button",
        {
          type: "button",
          class: "arm chip",
          style: `--c:${arm.colour}`,
          "data-arm": arm.key,
          title: arm.about || undefined,
          onclick: () => store.toggleArm(arm.key),
        },
        el("span", { class: "swatch", "aria-hidden": "true" }),
        arm.label,
      ),
    );
  const site = select("Site", siteOptions(model), (value) => store.set({ site: value }));
  const outcome = select("Outcome", [["all", "all"], ...OUTCOMES.map((o) => [o.id, o.label])], (value) =>
    store.set({ outcome: value }),
  );
  const reset = button(
    "Show all",
    () => store.set({ arms: START.arms, site: START.site, outcome: START.outcome }),
    { class: "reset" },
  );
  const link = button("Copy link", () => copyText(location.href, link));
  const theme = button("", () => {
    const names = Object.keys(THEMES);
    store.set({ theme: names[(names.indexOf(store.get().theme) + 1) % names.length] });
  });
  const node = el(
    "div",
    { id: "filters", role: "region", "aria-label": "What the pictures show" },
    el("div", { class: "chips" }, arms),
    el("div", { class: "choices" }, site.node, outcome.node, reset),
  );
  return {
    node,
    tools: el("div", { class: "chips tools" }, link, theme),
    update(state) {
      for (const chip of arms)
        chip.setAttribute("aria-pressed", String(state.arms.includes(chip.dataset.arm)));
      node.classList.toggle("some-arms", state.arms.length > 0);
      site.input.value = state.site;
      outcome.input.value = state.outcome;
      reset.disabled = state.arms.length === 0 && state.site === "all" && state.outcome === "all";
      theme.textContent = THEMES[state.theme] ?? THEMES.auto;
    },
  };
}

function siteOptions(model) {
  const options = [["all", "all"]];
  if (model.data.slices["known|all"]?.some(Boolean)) options.push(["known", "known to the warm-up"]);
  if (model.data.slices["unseen|all"]?.some(Boolean)) options.push(["unseen", "new to the networks"]);
  for (const site of model.sites.values()) options.push([String(site.number), site.name]);
  return options;
}

export function select(label, options, choose) {
  const input = el(
    "select",
    { onchange: () => choose(input.value) },
    options.map(([value, text]) => el("option", { value }, text)),
  );
  return { input, node: el("label", { class: "choice" }, `${label} `, input) };
}
