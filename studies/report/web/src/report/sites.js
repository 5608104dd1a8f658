// The places: a map with success at each site, and a table of sites by arms.
import { scaleLinear } from "d3-scale";
import { figure } from "../lib/chart.js";
import { asButton, el, svg } from "../lib/dom.js";
import { count, interval, number, withInterval } from "../lib/format.js";
import { OUTCOMES, shareColour } from "../lib/palette.js";
import { relief } from "../lib/relief.js";
import { order } from "../lib/table.js";
import { withTooltip } from "../lib/tooltip.js";

export function sites(model, store) {
  const { node, picture, behind } = figure(
    "sites",
    "Where: success at each fire site",
    "Circles are fire sites with their numbers, coloured by the success of the arms chosen (all their missions there, whatever outcome is chosen). Lines are " +
      "missions of the median duration, one for each outcome. A click on a site chooses it everywhere, in the map and in the table. In the table beneath each share its 95 % interval and the number of missions.",
  );
  picture.classList.add("two", "sites");
  const colourOf = colours(model);
  let sort = { by: "", down: false }; // an arm's key, "": by number
  let shown;
  const update = (state) => {
    shown = state;
    const sortBy = (by) => {
      sort = { by, down: sort.by === by ? !sort.down : by !== "" };
      update(shown);
    };
    picture.replaceChildren(
      mapOf(model, store, state, colourOf),
      matrix(model, store, state, colourOf, { sort, sortBy }),
    );
    behind.replaceChildren();
  };
  return { node, redrawOnTheme: true, update };
}

/** Success in percent -> colour; one scale for whatever is chosen. It begins at the worst site of any arm, so that differences show. */
function colours(model) {
  const rates = model.shown.flatMap((arm) =>
    [...model.sites.keys()].map(
      (site) => model.cell(arm, "msr_pct", { site: String(site), outcome: "all" })?.value ?? 100,
    ),
  );
  const low = Math.min(90, Math.floor(Math.min(...rates) / 10) * 10);
  const colour = (percent) => shareColour((percent - low) / (100 - low));
  return Object.assign(colour, { low });
}

function mapOf(model, store, state, colourOf) {
  const { world } = model.data;
  if (!world)
    return el("p", { class: "note" }, `No map: ${model.data.world_note || "the world is not at hand"}.`);
  const arms = model.chosen(state);
  const elsewhere = new Set(model.shown.map((arm) => arm.world)).size > 1;
  const [wide, deep] = world.size_m;
  const x = scaleLinear([0, wide], [0, 1000]);
  const y = scaleLinear([0, deep], [(1000 * deep) / wide, 0]);
  const root = svg("svg", {
    viewBox: `0 0 1000 ${(1000 * deep) / wide}`,
    class: "map",
    role: "group",
    "aria-label": `Map of ${world.name}`,
  });
  root.append(
    svg("image", {
      href: relief(world),
      x: 0,
      y: 0,
      width: 1000,
      height: (1000 * deep) / wide,
      preserveAspectRatio: "none",
    }),
  );
  for (const mission of model.data.missions_shown) root.append(path(mission, x, y, state));
  for (const station of world.base_stations)
    root.append(
      withTooltip(
        svg("rect", {
          class: "station",
          x: x(station.x_m) - 10,
          y: y(station.y_m) - 10,
          width: 20,
          height: 20,
          tabindex: 0,
          role: "img",
          "aria-label": `Base station ${station.name}`,
        }),
        () => [
          `Base station ${station.name}`,
          station.known ? "known to the warm-up" : "new to the networks",
        ],
      ),
    );
  root.append(northAndScale(x, (1000 * deep) / wide, wide));
  for (const site of model.sites.values())
    if (site.x_m !== undefined) root.append(siteMark(model, store, state, arms, site, x, y, colourOf));
  return el(
    "div",
    {},
    elsewhere &&
      el(
        "p",
        { class: "note" },
        `Arms fly in several worlds; the map is of ${world.name}, and site numbers are of each arm's own world.`,
      ),
    root,
    ramp(colourOf),
    mapLegend(model),
  );
}

/** A round length of about a fifth of the map, in metres. */
export function barLength(wide_m) {
  const power = 10 ** Math.floor(Math.log10(wide_m / 5));
  return [5, 2, 1].map((step) => step * power).find((length) => length <= wide_m / 5) ?? power;
}

/** Where north is, and how far a length on the map is. */
function northAndScale(x, height, wide_m) {
  const length = barLength(wide_m);
  const end = 20 + x(length);
  return svg(
    "g",
    { class: "orientation", "aria-hidden": "true" },
    svg("path", { d: "M965,78V30M953,46l12,-18l12,18" }),
    svg("text", { x: 965, y: 106, "text-anchor": "middle" }, "N"),
    svg("path", { d: `M20,${height - 30}v12H${end}v-12` }),
    svg("text", { x: (20 + end) / 2, y: height - 34, "text-anchor": "middle" }, `${count(length)} m`),
  );
}

const mapLegend = (model) =>
  el(
    "p",
    { class: "key legend" },
    [...model.sites.values()].some((site) => !site.known) &&
      el("span", {}, el("span", { class: "ring dashed", "aria-hidden": "true" }), "site new to the networks"),
    el("span", {}, el("span", { class: "square dark", "aria-hidden": "true" }), "base station"),
    model.data.missions_shown.length > 0 && [
      OUTCOMES.map((outcome) =>
        el(
          "span",
          {},
          el("span", { class: "stroke", style: `--c:var(${outcome.variable})`, "aria-hidden": "true" }),
          `a mission: ${outcome.label}`,
        ),
      ),
      el("span", {}, el("span", { class: "dot", "aria-hidden": "true" }), "its start"),
    ],
  );

function siteMark(model, store, state, arms, site, x, y, colourOf) {
  const there = model.pooled(arms, site.number);
  const share = there.missions > 0 ? there.success / there.missions : null;
  const colour = share === null ? { fill: "none", ink: "currentColor" } : colourOf(100 * share);
  const tell =
    share === null
      ? "no missions"
      : `${number(100 * share, 1)} % success in ${count(there.missions)} missions`;
  const off = !model.atSite(state, site.number);
  const at = `translate(${x(site.x_m)},${y(site.y_m)})`;
  const mark = svg(
    "g",
    {
      class: off ? "site off" : "site",
      transform: at,
      "data-site": site.number,
      "aria-pressed": String(state.site === String(site.number)),
      ...asButton(`${site.name}: ${tell}`, () => store.toggle("site", String(site.number))),
    },
    svg("circle", { r: 30, class: site.known ? "halo" : "halo unseen" }),
    svg("circle", { r: 25, fill: colour.fill }),
    svg("text", { "text-anchor": "middle", y: 8, fill: colour.ink }, site.shown),
  );
  return withTooltip(mark, () => [
    site.name,
    site.known ? "known to the warm-up" : "new to the networks",
    tell,
    ...arms
      .slice(0, 9)
      .map(
        (arm) =>
          `${arm.label}: ${withInterval(model.cell(arm, "msr_pct", { site: String(site.number), outcome: "all" }), model.byName.msr_pct)}`,
      ),
  ]);
}

function path(mission, x, y, state) {
  const outcome =
    OUTCOMES.find(
      (o) => o.label === { success: "success", "false-positive": "false alarm" }[mission.outcome],
    ) ?? OUTCOMES[2];
  const off = state.outcome !== "all" && state.outcome !== outcome.id;
  const d = `M${mission.x_m.map((at, i) => `${x(at).toFixed(1)},${y(mission.y_m[i]).toFixed(1)}`).join("L")}`;
  const node = svg(
    "g",
    { class: off ? "path off" : "path", style: `--c:var(${outcome.variable})` },
    svg("path", { class: "casing", d }),
    svg("path", { d }),
    svg("circle", { cx: x(mission.x_m[0]), cy: y(mission.y_m[0]), r: 7 }),
  );
  return withTooltip(node, () => [
    `${mission.label}, mission ${mission.mission}: ${outcome.label}`,
    `${number(mission.energy_kj, 2)} kJ in ${number(mission.duration_min, 2)} min`,
  ]);
}

const ramp = (colourOf) =>
  el(
    "p",
    { class: "ramp", "aria-hidden": "true" },
    `success ${colourOf.low} %`,
    el("span", {
      class: "ramp-colours",
      style: `background:linear-gradient(90deg,${[0, 0.2, 0.4, 0.6, 0.8, 1].map((s) => shareColour(s).fill).join(",")})`,
    }),
    "100 %",
  );

function matrix(model, store, state, colourOf, { sort, sortBy }) {
  const arms = model.chosen(state);
  const metric = model.byName.msr_pct;
  const places = [...model.sites.values()]
    .filter((site) => model.atSite(state, site.number))
    .sort((a, b) => b.known - a.known || a.number - b.number);
  const by = arms.find((arm) => arm.key === sort.by);
  if (by) {
    const rate = (site) => model.cell(by, metric.name, { site: String(site.number), outcome: "all" })?.value;
    places.sort((a, b) => (sort.down ? -1 : 1) * order(rate(a), rate(b)));
  } else if (sort.down) places.reverse();
  const head = (key, label, attributes) =>
    el(
      "th",
      {
        scope: "col",
        "aria-sort": sort.by !== key ? "none" : sort.down ? "descending" : "ascending",
        ...attributes,
      },
      el("button", { type: "button", class: "sort", onclick: () => sortBy(key) }, label),
    );
  const pools = [
    ["known", "all known"],
    ["unseen", "all new"],
  ].filter(
    ([id]) =>
      state.site === "all" && arms.some((arm) => model.missions(arm, { site: id, outcome: "all" }) > 0),
  );
  const row = (id, name, extra) => {
    const chosen = state.site === id;
    return el(
      "tr",
      { "data-site": id, class: extra },
      el(
        "th",
        { scope: "row", class: "left" },
        el(
          "button",
          {
            type: "button",
            class: "link",
            "aria-pressed": String(chosen),
            onclick: () => store.toggle("site", id),
          },
          name,
        ),
      ),
      arms.map((arm) => {
        const cell = model.cell(arm, metric.name, { site: id, outcome: "all" });
        if (!cell) return el("td", { class: "share" }, "–");
        const colour = colourOf(cell.value);
        return withTooltip(
          el(
            "td",
            {
              class: "share",
              style: `background:${colour.fill};color:${colour.ink}`,
              title: withInterval(cell, metric),
            },
            el("b", {}, number(cell.value, 0)),
            el(
              "small",
              {},
              [interval(cell.lo, cell.hi, 0), `n ${count(cell.missions)}`].filter(Boolean).join(" · "),
            ),
          ),
          () => [
            `${arm.label} at ${name}`,
            `success ${withInterval(cell, metric)}`,
            `${count(cell.missions)} missions`,
          ],
        );
      }),
    );
  };
  return el(
    "div",
    { class: "wide", tabindex: 0, role: "region", "aria-label": "Success by site and arm" },
    el(
      "table",
      { class: "matrix", id: "site-table" },
      el("caption", { class: "hidden" }, "Success rate in percent by site and arm"),
      el(
        "thead",
        {},
        el(
          "tr",
          {},
          head("", "success, %", { class: "left" }),
          arms.map((arm) => head(arm.key, arm.label, { style: `--c:${arm.colour}` })),
        ),
      ),
      el(
        "tbody",
        {},
        places.map((site) => row(String(site.number), site.name, site.known ? "" : "unseen")),
        pools.map(([id, name]) => row(id, name, "pool")),
      ),
    ),
  );
}
