// The page's data as its views ask for them. Nothing is estimated here: values and intervals come from the engine, one set
// for each filter; counts of missions are added up, which is exact.

export function makeModel(data) {
  const metrics = data.metrics.map((metric, index) => ({ ...metric, index }));
  const byName = Object.fromEntries(metrics.map((metric) => [metric.name, metric]));
  const arms = data.arms.map((arm, index) => ({ ...arm, index, colour: `var(--arm-${index})` }));
  const flown = besideOneAnother(arms.filter((arm) => arm.missions > 0));
  const shown = flown.some((arm) => !arm.warmup) ? flown.filter((arm) => !arm.warmup) : flown;
  const sites = sitesOf(data);

  const sliceName = ({ site, outcome }) => `${site}|${outcome}`;

  /** {value, lo, hi, missions} of one metric of one arm, or null. */
  function cell(arm, metricName, filter = { site: "all", outcome: "all" }) {
    const row = data.slices[sliceName(filter)]?.[arm.index];
    if (!row) return null;
    const at = 1 + 3 * byName[metricName].index;
    return { value: row[at], lo: row[at + 1], hi: row[at + 2], missions: row[0] };
  }

  const missions = (arm, filter) => data.slices[sliceName(filter)]?.[arm.index]?.[0] ?? 0;

  /** Arms that the reader has chosen, in plan order; all that the page is about where none is. */
  const chosen = (state) => {
    const wanted = flown.filter((arm) => state.arms.includes(arm.key));
    return wanted.length > 0 ? wanted : shown;
  };

  const atSite = (filter, site) =>
    filter.site === "all" ||
    filter.site === String(site) ||
    (filter.site === "known" && sites.get(site)?.known) ||
    (filter.site === "unseen" && !sites.get(site)?.known);

  /** Counts of missions by bin for each outcome: [[...], [...], [...]]. */
  function histogram(arm, column, filter) {
    const s = data.histograms.scales.findIndex((scale) => scale.column === column);
    const scale = data.histograms.scales[s];
    const counts = [0, 1, 2].map(() => new Array(scale.bins).fill(0));
    for (const [a, site, outcome, inScale, first, ...bins] of data.histograms.cells) {
      if (a !== arm.index || inScale !== s || !atSite(filter, site)) continue;
      if (filter.outcome !== "all" && filter.outcome !== String(outcome)) continue;
      bins.forEach((n, i) => (counts[outcome][first + i] += n));
    }
    return { scale, counts };
  }

  /** Missions and successes of these arms at a site: pooled over them. */
  function pooled(chosenArms, site) {
    const total = { missions: 0, success: 0, falseAlarm: 0, depleted: 0 };
    for (const arm of chosenArms) {
      const of = (outcome) => missions(arm, { site: String(site), outcome });
      const all = of("all");
      total.missions += all;
      const rate = cell(arm, "msr_pct", { site: String(site), outcome: "all" });
      if (rate) total.success += Math.round((rate.value / 100) * all);
    }
    return total;
  }

  const shownNames = new Set([...sites.values()].map((site) => site.shown));
  const distinct = shownNames.size === sites.size;

  /** A choice of sites in addresses: sites by the number that they are shown with. */
  const siteToAddress = (site) => (distinct && sites.get(Number(site))?.shown) || site;
  const siteFromAddress = (text) => {
    const found = distinct && [...sites.values()].find((site) => site.shown === text);
    return found ? String(found.number) : text;
  };

  const command = (arm, number) =>
    `ed3r replay ${quoted(arm.dir ?? data.run.dir)} ${quoted(`${arm.stored_name}/${number}`)} --html`;

  /** The viewer beside the page that shows this mission, or undefined. */
  const viewer = (arm, number) =>
    data.viewers.find(({ mission }) => !arm.dir && mission === `${arm.stored_name}/${number}`)?.file;

  return {
    data,
    metrics,
    byName,
    arms,
    flown,
    shown,
    sites,
    cell,
    missions,
    chosen,
    atSite,
    histogram,
    pooled,
    siteToAddress,
    siteFromAddress,
    command,
    viewer,
  };
}

/** Of runs that are compared: the same arm of each run in a row. */
function besideOneAnother(arms) {
  const first = new Map();
  for (const arm of arms) if (!first.has(arm.stored_name)) first.set(arm.stored_name, arm.index);
  return [...arms].sort((a, b) => first.get(a.stored_name) - first.get(b.stored_name) || a.index - b.index);
}

/** A word for a POSIX shell. */
export const quoted = (word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", `'\\''`)}'`);

/** Number -> {number, name, known, x_m, y_m} of every site that was flown; the world may be unknown. */
function sitesOf(data) {
  const numbers = new Set(
    Object.keys(data.slices)
      .map((name) => name.split("|")[0])
      .filter((site) => /^\d+$/.test(site))
      .map(Number),
  );
  const known = knownSites(data);
  return new Map(
    [...numbers]
      .sort((a, b) => a - b)
      .map((number) => {
        const place = data.world?.sites[number];
        return [
          number,
          {
            number,
            shown: shown(number, place?.name),
            name: place?.name ?? `site ${number}`,
            x_m: place?.x_m,
            y_m: place?.y_m,
            known: known.has(number),
          },
        ];
      }),
  );
}

/** What a site is called in short, in circles and addresses: the number in its name, else the engine's. */
const shown = (number, name) => /(\d+)$/.exec(name ?? "")?.[1] ?? String(number);

const knownSites = (data) => new Set(data.known_sites);
