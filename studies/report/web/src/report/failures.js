// Missions that failed, by cause, each with the command that flies it again.
import { button, copyText, el } from "../lib/dom.js";
import { count, number, plural } from "../lib/format.js";

export function failures(model) {
  const list = el("div");
  const node = el("section", { id: "failures" }, watch(model), el("h2", {}, "Missions that failed"), list);
  return {
    node,
    title: "Failures",
    update(state) {
      const groups = groupsOf(model, state);
      list.replaceChildren(
        ...(groups.length > 0
          ? groups.map((group) => groupNode(model, group))
          : [el("p", {}, "None in this selection.")]),
        ...broken(model),
      );
    },
  };
}

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** Links to viewers beside the page. */
function watch(model) {
  const { viewers } = model.data;
  if (viewers.length === 0)
    return model.data.viewers_note && el("p", { class: "note" }, capital(model.data.viewers_note));
  return [
    el("h2", { id: "watch" }, "Missions to watch"),
    el(
      "ul",
      { class: "watch" },
      viewers.map(({ mission, what, file }) =>
        el("li", {}, el("a", { href: encodeURI(file) }, mission), `: ${what}`),
      ),
    ),
    el(
      "p",
      { class: "key" },
      "Any other: its command below writes mission.html; two on one clock: ",
      el("code", {}, "--beside ARM/NUMBER"),
      ".",
    ),
  ];
}

/** [{cause, count, arms: [{arm, count, missions}]}], the most frequent cause first. A site filter hides missions that are listed, not counts. */
export function groupsOf(model, state) {
  const chosen = new Set(model.chosen(state).map((arm) => arm.index));
  const causes = new Map();
  for (const group of model.data.failures) {
    if (!chosen.has(group.arm) || (state.outcome !== "all" && state.outcome !== String(group.outcome)))
      continue;
    const missions = group.missions.filter(([, site]) => model.atSite(state, site));
    const whole = state.site === "all";
    if (missions.length === 0) continue;
    const known = causes.get(group.cause) ?? { cause: group.cause, count: 0, whole, arms: [] };
    const here = whole ? group.count : missions.length;
    known.count += here;
    known.arms.push({
      arm: model.arms[group.arm],
      count: here,
      missions,
      cut: group.missions.length < group.count,
    });
    causes.set(group.cause, known);
  }
  return [...causes.values()].sort((a, b) => b.count - a.count);
}

function groupNode(model, group) {
  const some = !group.whole && group.arms.some((part) => part.cut);
  return el(
    "div",
    { class: "cause" },
    el("h3", {}, `${count(group.count)}${some ? " or more" : ""} · ${group.cause}`),
    el(
      "div",
      { class: "cause-arms" },
      group.arms.map((part) => armNode(model, part)),
    ),
  );
}

const armNode = (model, { arm, count: n, missions, cut }) => {
  const body = el("ul", { class: "commands" });
  const details = el(
    "details",
    {
      ontoggle: () =>
        details.open &&
        body.childElementCount === 0 &&
        body.append(...missions.map((mission) => item(model, arm, mission))),
    },
    el(
      "summary",
      {},
      el("span", { class: "swatch", style: `--c:${arm.colour}`, "aria-hidden": "true" }),
      ` ${arm.label}: ${plural(n, "mission")} of ${count(arm.missions)}${cut ? `, the first ${missions.length} listed` : ""}`,
    ),
    body,
  );
  return details;
};

function item(model, arm, [missionNumber, site, energy, duration]) {
  const command = model.command(arm, missionNumber);
  const file = model.viewer(arm, missionNumber);
  const copy = button("Copy", () => copyText(command, copy), {
    class: "small",
    "aria-label": `Copy the command for mission ${missionNumber} of ${arm.label}`,
  });
  return el(
    "li",
    {},
    el("code", {}, command),
    " ",
    copy,
    file && [" ", el("a", { href: encodeURI(file) }, "watch")],
    el("small", {}, ` ${model.sites.get(site)?.name}, ${number(energy, 1)} kJ, ${number(duration, 1)} min`),
  );
}

function broken(model) {
  const list = model.data.broken;
  if (list.length === 0) return [];
  return [
    el(
      "div",
      { class: "cause" },
      el("h3", {}, `${count(list.length)} · broke down inside the program (counted in no rate)`),
      el(
        "ul",
        { class: "commands" },
        list
          .slice(0, 60)
          .map((mission) =>
            el("li", {}, el("code", {}, mission.mission), el("small", {}, ` ${mission.message}`)),
          ),
      ),
    ),
  ];
}
