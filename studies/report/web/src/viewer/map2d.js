// The mission from above: what is left where the browser has no WebGL.
import { scaleLinear } from "d3-scale";
import { el, svg } from "../lib/dom.js";
import { shareColour } from "../lib/palette.js";
import { relief } from "../lib/relief.js";
import { misleader } from "./mission.js";

export function makeMap(world, mission) {
  const [wide, deep] = world.size_m;
  const height = (1000 * deep) / wide;
  const x = scaleLinear([0, wide], [0, 1000]);
  const y = scaleLinear([0, deep], [height, 0]);
  const robot = svg("g", { class: "robot" }, svg("path", { d: "M0,-16L10,12L0,6L-10,12z" }));
  const station = world.base_stations[mission.data.base_station];
  const link = svg("line", { class: "link", x1: x(station.x_m), y1: y(station.y_m) });
  const points = mission.path();
  const { places = [] } = mission.data.distractors ?? {};
  const lures = places.map(([px, py, , radius]) =>
    svg("circle", { class: "lure", cx: x(px), cy: y(py), r: Math.max(3, x(radius) - x(0)) }),
  );
  const root = svg(
    "svg",
    {
      viewBox: `0 0 1000 ${height}`,
      class: "map",
      role: "img",
      "aria-label": `The mission of ${mission.data.label} from above`,
    },
    svg("image", {
      href: relief({ ...world, trees: world.trees.map(([tx, ty, , , radius]) => [tx, ty, radius]) }),
      width: 1000,
      height,
      preserveAspectRatio: "none",
    }),
    world.base_stations.map((s) =>
      svg("rect", { class: "station", x: x(s.x_m) - 9, y: y(s.y_m) - 9, width: 18, height: 18 }),
    ),
    world.sites.map((site, i) =>
      svg("circle", {
        class: i === mission.data.site ? "fire" : "cold",
        cx: x(site.x_m),
        cy: y(site.y_m),
        r: i === mission.data.site ? 13 : 6,
      }),
    ),
    lures,
    link,
    points.slice(1).map((p, i) =>
      svg("line", {
        class: "leg",
        x1: x(points[i].x),
        y1: y(points[i].y),
        x2: x(p.x),
        y2: y(p.y),
        stroke: shareColour(mission.steps.scs[p.step]).fill,
      }),
    ),
    robot,
  );
  return {
    node: el("div", { class: "view flat" }, root),
    update(time) {
      const pose = mission.pose(time);
      robot.setAttribute(
        "transform",
        `translate(${x(pose.x)},${y(pose.y)}) rotate(${90 - (pose.yaw * 180) / Math.PI})`,
      );
      const misleads = misleader(mission, mission.lookedAt(time));
      lures.forEach((lure, i) => lure.classList.toggle("misleads", i === misleads));
      link.setAttribute("x2", x(pose.x));
      link.setAttribute("y2", y(pose.y));
    },
    draw() {},
    look() {},
  };
}
