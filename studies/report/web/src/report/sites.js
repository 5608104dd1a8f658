// The places: a map with success at each site, and a table of sites by arms.
import { scaleLinear } from "d3-scale";
import { figure } from "../lib/chart.js";
import { asButton, el, svg } from "../lib/dom.js";
import { count, number, withInterval } from "../lib/format.js";
import { OUTCOMES, shareColour } from "../lib/palette.js";
import { withTooltip } from "../lib/tooltip.js";

const LIGHT = { x: -0.6, y: 0.6, z: 0.55 }; // from the north-west

export function sites(model, store) {
  const { node, picture, behind } = figure(
    "sites",
    "Where: success at each fire site",
    "Circles are fire sites, coloured by the success of the arms chosen (all their missions there); a dashed ring: new to the networks. Squares are base stations. Lines are " +
      "missions of the median duration, one for each outcome. A click on a site chooses it everywhere, in the map and in the table.",
  );
  picture.classList.add("two", "sites");
  return {
    node,
    redrawOnTheme: true,
    update(state) {
      picture.replaceChildren(mapOf(model, store, state), matrix(model, store, state));
      behind.replaceChildren();
    },
  };
}

function mapOf(model, store, state) {
  const { world } = model.data;
  if (!world) return el("p", { class: "note" }, `No map: ${model.data.world_note || "the world is not at hand"}.`);
  const arms = model.chosen(state);
  const elsewhere = new Set(model.shown.map((arm) => arm.world)).size > 1;
  const [wide, deep] = world.size_m;
  const x = scaleLinear([0, wide], [0, 1000]);
  const y = scaleLinear([0, deep], [(1000 * deep) / wide, 0]);
  const root = svg("svg", { viewBox: `0 0 1000 ${(1000 * deep) / wide}`, class: "map", role: "group", "aria-label": `Map of ${world.name}` });
  root.append(svg("image", { href: relief(world), x: 0, y: 0, width: 1000, height: (1000 * deep) / wide, preserveAspectRatio: "none" }));
  for (const mission of model.data.missions_shown) root.append(path(mission, x, y, state));
  for (const station of world.base_stations)
    root.append(
      withTooltip(svg("rect", { class: "station", x: x(station.x_m) - 10, y: y(station.y_m) - 10, width: 20, height: 20, tabindex: 0, role: "img", "aria-label": `Base station ${station.name}` }), () => [
        `Base station ${station.name}`,
        station.known ? "known to the warm-up" : "new to the networks",
      ]),
    );
  for (const site of model.sites.values()) if (site.x_m !== undefined) root.append(siteMark(model, store, state, arms, site, x, y));
  return el("div", {}, elsewhere && el("p", { class: "note" }, `Arms fly in several worlds; the map is of ${world.name}, and site numbers are of each arm's own world.`), root, ramp());
}

function siteMark(model, store, state, arms, site, x, y) {
  const there = model.pooled(arms, site.number);
  const share = there.missions > 0 ? there.success / there.missions : null;
  const colour = share === null ? { fill: "none", ink: "currentColor" } : shareColour(share);
  const tell = share === null ? "no missions" : `${number(100 * share, 1)} % success in ${count(there.missions)} missions`;
  const off = !model.atSite(state, site.number);
  const at = `translate(${x(site.x_m)},${y(site.y_m)})`;
  const mark = svg(
    "g",
    { class: off ? "site off" : "site", transform: at, "data-site": site.number, "aria-pressed": String(state.site === String(site.number)), ...asButton(`${site.name}: ${tell}`, () => store.toggle("site", String(site.number))) },
    svg("circle", { r: 30, class: site.known ? "halo" : "halo unseen" }),
    svg("circle", { r: 25, fill: colour.fill }),
    svg("text", { "text-anchor": "middle", y: 8, fill: colour.ink }, share === null ? "–" : number(100 * share, 0)),
  );
  return withTooltip(mark, () => [
    site.name,
    site.known ? "known to the warm-up" : "new to the networks",
    tell,
    ...arms.slice(0, 9).map((arm) => `${arm.label}: ${withInterval(model.cell(arm, "msr_pct", { site: String(site.number), outcome: "all" }), model.byName.msr_pct)}`),
  ]);
}

function path(mission, x, y, state) {
  const outcome = OUTCOMES.find((o) => o.label === { success: "success", "false-positive": "false alarm" }[mission.outcome]) ?? OUTCOMES[2];
  const off = state.outcome !== "all" && state.outcome !== outcome.id;
  const d = `M${mission.x_m.map((at, i) => `${x(at).toFixed(1)},${y(mission.y_m[i]).toFixed(1)}`).join("L")}`;
  const node = svg("g", { class: off ? "path off" : "path", style: `--c:var(${outcome.variable})` }, svg("path", { class: "casing", d }), svg("path", { d }), svg("circle", { cx: x(mission.x_m[0]), cy: y(mission.y_m[0]), r: 7 }));
  return withTooltip(node, () => [`${mission.label}, mission ${mission.mission}: ${outcome.label}`, `${number(mission.energy_kj, 2)} kJ in ${number(mission.duration_min, 2)} min`]);
}

/** Shaded ground with its trees, as a picture in a data URL. */
function relief(world) {
  const rows = world.height_m.length,
    columns = world.height_m[0].length;
  const scale = 3;
  const canvas = el("canvas", { width: columns * scale, height: rows * scale });
  const pen = canvas.getContext("2d");
  const small = el("canvas", { width: columns, height: rows });
  const picture = small.getContext("2d").createImageData(columns, rows);
  const heights = world.height_m.flat();
  const low = Math.min(...heights),
    high = Math.max(...heights);
  const dark = isDark();
  const at = (r, c) => world.height_m[Math.max(0, Math.min(rows - 1, r))][Math.max(0, Math.min(columns - 1, c))];
  for (let r = 0; r < rows; ++r)
    for (let c = 0; c < columns; ++c) {
      const dx = (at(r, c + 1) - at(r, c - 1)) / (2 * world.cell_m),
        dy = (at(r + 1, c) - at(r - 1, c)) / (2 * world.cell_m);
      const lit = Math.max(0, (-LIGHT.x * dx - LIGHT.y * dy + LIGHT.z) / Math.hypot(dx, dy, 1));
      const level = (at(r, c) - low) / Math.max(1, high - low);
      const shade = (dark ? 0.34 : 0.78) * (0.62 + 0.62 * lit) + (dark ? 0.08 : 0.06) * level;
      const pixel = 4 * ((rows - 1 - r) * columns + c);
      [0.93, 0.97, 0.88].forEach((tint, i) => (picture.data[pixel + i] = 255 * Math.min(1, shade * tint)));
      picture.data[pixel + 3] = 255;
    }
  small.getContext("2d").putImageData(picture, 0, 0);
  pen.drawImage(small, 0, 0, canvas.width, canvas.height);
  pen.fillStyle = dark ? "rgba(120,170,130,.35)" : "rgba(60,100,70,.28)";
  for (const [tx, ty, radius] of world.trees) {
    pen.beginPath();
    pen.arc((tx / world.size_m[0]) * canvas.width, canvas.height - (ty / world.size_m[1]) * canvas.height, Math.max(0.8, (radius / world.size_m[0]) * canvas.width), 0, 7);
    pen.fill();
  }
  return canvas.toDataURL();
}

export function isDark() {
  const probe = el("span", { style: "color:light-dark(#000,#fff)" });
  document.body.append(probe);
  const dark = getComputedStyle(probe).color.includes("255");
  probe.remove();
  return dark;
}

const ramp = () =>
  el(
    "p",
    { class: "ramp", "aria-hidden": "true" },
    "success 0 %",
    el("span", { class: "ramp-colours", style: `background:linear-gradient(90deg,${[0, 0.2, 0.4, 0.6, 0.8, 1].map((s) => shareColour(s).fill).join(",")})` }),
    "100 %",
  );

function matrix(model, store, state) {
  const arms = model.chosen(state);
  const metric = model.byName.msr_pct;
  const places = [...model.sites.values()].filter((site) => model.atSite(state, site.number)).sort((a, b) => b.known - a.known || a.number - b.number);
  const pools = [["known", "all known"], ["unseen", "all new"]].filter(([id]) => state.site === "all" && arms.some((arm) => model.missions(arm, { site: id, outcome: "all" }) > 0));
  const row = (id, name, extra) => {
    const chosen = state.site === id;
    return el(
      "tr",
      { "data-site": id, class: extra },
      el("th", { scope: "row", class: "left" }, el("button", { type: "button", class: "link", "aria-pressed": String(chosen), onclick: () => store.toggle("site", id) }, name)),
      arms.map((arm) => {
        const cell = model.cell(arm, metric.name, { site: id, outcome: "all" });
        if (!cell) return el("td", { class: "share" }, "–");
        const colour = shareColour(cell.value / 100);
        return withTooltip(el("td", { class: "share", style: `background:${colour.fill};color:${colour.ink}`, title: withInterval(cell, metric) }, number(cell.value, 0)), () => [
          `${arm.label} at ${name}`,
          `success ${withInterval(cell, metric)}`,
          `${count(cell.missions)} missions`,
        ]);
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
      el("thead", {}, el("tr", {}, el("th", { scope: "col", class: "left" }, "success, %"), arms.map((arm) => el("th", { scope: "col", style: `--c:${arm.colour}` }, arm.label)))),
      el("tbody", {}, places.map((site) => row(String(site.number), site.name, site.known ? "" : "unseen")), pools.map(([id, name]) => row(id, name, "pool"))),
    ),
  );
}
