// Missions that failed, by cause, each with the command that flies it again.
import { button, copyText, el } from "../lib/dom.js";
import { count, number, plural } from "../lib/format.js";

const FALSE_ALARM =
  "A look is one timestep's pictures and the score (SCS) that a detector gave them. In a false alarm nothing burns where the robot is sure of it: " +
  "harmless things that look like fire, drawn anew for each mission and equal for all arms, misled it.";
const HOW_TO_SEE_ONE =
  "Missions with “▶ watch” can be seen at once; of any other the command, run where the run's folder is, writes such a page (mission.html).";

export function failures(model) {
  const list = el("div");
  const node = el(
    "section",
    { id: "failures" },
    watch(model),
    el("h2", {}, "Missions that failed"),
    el("p", { class: "key" }, FALSE_ALARM, " ", model.data.viewers.length > 0 && HOW_TO_SEE_ONE),
    list,
  );
  return {
    node,
    title: "Failures",
    update(state) {
      const groups = groupsOf(model, state);
      list.replaceChildren(
        ...(groups.length > 0
          ? groups.map((group) => groupNode(model, group, state))
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
        el("li", {}, el("a", { class: "watch-link", href: encodeURI(file) }, `▶ ${what}`), ` ${mission}`),
      ),
    ),
    el(
      "p",
      { class: "key" },
      "Any other mission has a command in the list below, and under “Every mission” above after a click on its point; with ",
      el("code", {}, "--beside ARM/NUMBER"),
      " two missions are shown on one clock.",
    ),
  ];
}

/** Missions of a group at the places chosen: of all, not of those listed. */
export const countAt = (group, site) =>
  site === "all"
    ? group.count
    : site === "known"
      ? group.known
      : site === "unseen"
        ? group.count - group.known
        : (group.sites[site] ?? 0);

/** [{cause, count, arms: [{arm, count, of, missions}]}], the most frequent cause first; `of` is all missions of the arm there. */
export function groupsOf(model, state) {
  const chosen = new Set(model.chosen(state).map((arm) => arm.index));
  const causes = new Map();
  for (const group of model.data.failures) {
    if (!chosen.has(group.arm) || (state.outcome !== "all" && state.outcome !== String(group.outcome)))
      continue;
    const here = countAt(group, state.site);
    if (here === 0) continue;
    const known = causes.get(group.cause) ?? { cause: group.cause, count: 0, arms: [] };
    const arm = model.arms[group.arm];
    known.count += here;
    known.arms.push({
      arm,
      count: here,
      of: model.missions(arm, { site: state.site, outcome: "all" }),
      outcome: group.outcome,
      missions: group.missions.filter(([, site]) => model.atSite(state, site)),
    });
    causes.set(group.cause, known);
  }
  return [...causes.values()].sort((a, b) => b.count - a.count);
}

const PLACES = { all: "", known: " at known sites", unseen: " at new sites" };

/** "8 of 40 missions at this site, the first 5 listed". */
export function partWords({ count: n, of, missions }, site) {
  const place = PLACES[site] ?? " at this site";
  const listed = missions.length;
  const rest =
    listed === n
      ? ""
      : listed === 0
        ? ", none listed"
        : `, ${listed === 1 ? "one" : count(listed)} of them listed`;
  return `${count(n)} of ${plural(of, "mission")}${place}${rest}`;
}

/** Why, in short, from what is stored of the mission. */
export function whyShort(outcome, timesteps, reliable) {
  const looks = plural(timesteps, "look");
  if (outcome === 1) return `sure of a fire after ${looks}, ${count(reliable)} above the threshold`;
  return reliable === 0
    ? `${looks}, none above the threshold`
    : `${looks}, ${count(reliable)} above the threshold, never enough in a row`;
}

const groupNode = (model, group, state) =>
  el(
    "div",
    { class: "cause" },
    el("h3", {}, `${count(group.count)} · ${group.cause}`),
    el(
      "div",
      { class: "cause-arms" },
      group.arms.map((part) => armNode(model, part, state)),
    ),
  );

function armNode(model, part, state) {
  const { arm, missions, outcome } = part;
  const watchable = missions.filter(([number]) => model.viewer(arm, number)).length;
  const body = el("ul", { class: "commands" });
  // Those that can be watched at once come first.
  const sorted = [...missions].sort(
    (a, b) => Boolean(model.viewer(arm, b[0])) - Boolean(model.viewer(arm, a[0])),
  );
  const details = el(
    "details",
    {
      ontoggle: () =>
        details.open &&
        body.childElementCount === 0 &&
        body.append(...sorted.map((mission) => item(model, arm, outcome, mission))),
    },
    el(
      "summary",
      {},
      el("span", { class: "swatch", style: `--c:${arm.colour}`, "aria-hidden": "true" }),
      ` ${arm.label}: ${partWords(part, state.site)}${watchable > 0 ? `, ${watchable} to watch` : ""}`,
    ),
    body,
  );
  return details;
}

function item(model, arm, outcome, [missionNumber, site, energy, duration, timesteps, reliable]) {
  const command = model.command(arm, missionNumber);
  const file = model.viewer(arm, missionNumber);
  const copy = button("Copy", () => copyText(command, copy), {
    class: "small",
    "aria-label": `Copy the command for mission ${missionNumber} of ${arm.label}`,
  });
  return el(
    "li",
    {},
    el("b", {}, `mission ${missionNumber}`),
    `, ${model.sites.get(site)?.name}: ${whyShort(outcome, timesteps, reliable)} `,
    el("small", {}, `${number(energy, 1)} kJ, ${number(duration, 1)} min`),
    file && [" ", el("a", { class: "watch-link", href: encodeURI(file) }, "▶ watch")],
    el("div", { class: "command" }, el("code", {}, command), " ", copy),
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
