// The mission in its world: ground, trees, fire and smoke, base stations, the path coloured by SCS, the robot with what its
// camera sees and its radio link. World frame x east, y north, z up; three's is x right, y up, z towards the viewer.
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  Color,
  ConeGeometry,
  CylinderGeometry,
  DirectionalLight,
  DoubleSide,
  DynamicDrawUsage,
  Fog,
  Group,
  InstancedMesh,
  Line,
  LineDashedMaterial,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  PerspectiveCamera,
  PlaneGeometry,
  Quaternion,
  Scene,
  SphereGeometry,
  Sprite,
  SpriteMaterial,
  TorusGeometry,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { el } from "../lib/dom.js";
import { shareColour } from "../lib/palette.js";
import { misleader } from "./mission.js";
import { lidarRays, robotOf } from "./robot3d.js";
import { toThree } from "./world_axes.js";

const SMOKE_PUFFS = 14;

export function hasWebGl() {
  try {
    return Boolean(document.createElement("canvas").getContext("webgl2"));
  } catch {
    return false;
  }
}

export function makeScene(world, mission, dark) {
  const renderer = new WebGLRenderer({ antialias: true });
  renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
  const scene = new Scene();
  const sky = new Color(dark ? "#131b22" : "#cfdde6");
  scene.background = sky;
  scene.fog = new Fog(sky, 500, 2200);
  scene.add(new AmbientLight(0xffffff, dark ? 0.9 : 1.3), sun(dark));
  scene.add(ground(world, dark), trees(world, dark));
  const fire = fireAt(world, mission.data.site);
  scene.add(fire.node, stations(world, mission.data.base_station), coldSites(world, mission.data.site));
  const path = pathOf(mission);
  const robot = robotOf(mission);
  const link = linkLine();
  const rays = lidarRays(mission);
  robot.node.add(sign("robot", 9));
  const lures = luresOf(mission);
  scene.add(path.node, robot.node, rays.node, link, lures.node);
  const camera = new PerspectiveCamera(50, 1, 0.5, 5000);
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.maxPolarAngle = Math.PI * 0.495;
  controls.enableDamping = false;
  renderer.domElement.setAttribute("role", "img");
  renderer.domElement.setAttribute("aria-label", `The mission of ${mission.data.label} in three dimensions`);
  const frame = el("div", { class: "frame", hidden: true }, el("span", {}, "the camera's picture"));
  const node = el("div", { class: "view" }, renderer.domElement, frame);
  let mode = "overview",
    time = 0;

  // However many things change, a picture is drawn once a frame.
  let queued = false;
  const render = () => {
    if (queued) return;
    queued = true;
    requestAnimationFrame(() => {
      queued = false;
      renderer.render(scene, camera);
    });
  };
  controls.addEventListener("change", render);

  function place() {
    const pose = mission.pose(time);
    const at = toThree(pose.x, pose.y, pose.z);
    const ahead = new Vector3(
      Math.cos(pose.yaw) * Math.cos(pose.tilt),
      -Math.sin(pose.tilt),
      -Math.sin(pose.yaw) * Math.cos(pose.tilt),
    );
    const seen = onboard(mission.data.camera, camera.aspect);
    camera.fov = mode === "onboard" ? seen.fov_deg : 50;
    frame.hidden = mode !== "onboard";
    frame.style.width = `${100 * seen.wide}%`;
    frame.style.height = `${100 * seen.high}%`;
    controls.enabled = mode !== "onboard";
    robot.node.visible = rays.node.visible = path.node.visible = link.visible = mode !== "onboard";
    if (mode === "onboard") {
      camera.position.copy(at);
      camera.lookAt(at.clone().add(ahead));
    } else if (mode === "follow") {
      camera.position.copy(at).add(new Vector3(-Math.cos(pose.yaw) * 60, 34, Math.sin(pose.yaw) * 60));
      controls.target.copy(at);
      camera.lookAt(at);
    }
    camera.updateProjectionMatrix();
  }

  return {
    node,
    update(now) {
      time = now;
      const pose = mission.pose(time);
      robot.move(pose, mission.phase(time));
      rays.move(pose, time);
      path.until(mission.stepAt(time), mission.ended(time));
      lures.mark(mission.lookedAt(time));
      fire.flicker(time);
      moveLink(link, world, mission, pose, time);
      if (mode !== "overview") place();
      render();
    },
    look(to) {
      mode = to;
      if (mode === "overview") overview(camera, controls, world, mission);
      place();
      render();
    },
    draw() {
      const width = node.clientWidth,
        height = node.clientHeight;
      if (width === 0) return;
      renderer.setSize(width, height);
      camera.aspect = width / height;
      if (mode === "onboard") place();
      camera.updateProjectionMatrix();
      render();
    },
  };
}

const AROUND = 1.12; // the view on board shows a little more than the camera sees, so that the picture's edge is in sight

/** The view's angle from top to bottom, which three asks for, and the shares of the view that the camera's picture takes. */
export function onboard({ hfov_deg, aspect }, viewAspect) {
  const wide = Math.tan((hfov_deg * Math.PI) / 360),
    high = wide / aspect;
  const half = AROUND * Math.max(high, wide / viewAspect);
  return {
    fov_deg: (2 * Math.atan(half) * 180) / Math.PI,
    wide: wide / (half * viewAspect),
    high: high / half,
  };
}

/** From the south, above, so that path and fire are in sight. */
function overview(camera, controls, world, mission) {
  const points = mission.path();
  const site = world.sites[mission.data.site];
  const all = [...points, { x: site.x_m, y: site.y_m, z: site.z_m }];
  const middle = ["x", "y", "z"].map(
    (axis) => (Math.min(...all.map((p) => p[axis])) + Math.max(...all.map((p) => p[axis]))) / 2,
  );
  const reach = Math.max(
    90,
    ...["x", "y"].map((axis) => Math.max(...all.map((p) => p[axis])) - Math.min(...all.map((p) => p[axis]))),
  );
  const target = toThree(...middle);
  controls.target.copy(target);
  camera.position.copy(target).add(new Vector3(-0.25 * reach, 0.75 * reach, 1.15 * reach));
  camera.lookAt(target);
  controls.update();
}

function sun(dark) {
  const light = new DirectionalLight(0xfff2dd, dark ? 1.1 : 2);
  light.position.set(-600, 900, -500);
  return light;
}

function ground(world, dark) {
  const rows = world.height_m.length,
    columns = world.height_m[0].length;
  const wide = (columns - 1) * world.cell_m,
    deep = (rows - 1) * world.cell_m;
  const geometry = new PlaneGeometry(wide, deep, columns - 1, rows - 1);
  const position = geometry.attributes.position;
  const colours = new Float32Array(position.count * 3);
  const heights = world.height_m.flat();
  const low = Math.min(...heights),
    high = Math.max(...heights);
  const valley = new Color(dark ? "#33463a" : "#8fa37c"),
    ridge = new Color(dark ? "#5d6058" : "#cfc9b1");
  for (let i = 0; i < position.count; ++i) {
    // The plane's rows go from its top, which is north, to the south.
    const height = world.height_m[rows - 1 - Math.floor(i / columns)][i % columns];
    position.setXYZ(i, position.getX(i) + wide / 2, height, -(position.getY(i) + deep / 2));
    const colour = valley.clone().lerp(ridge, (height - low) / Math.max(1, high - low));
    colours.set([colour.r, colour.g, colour.b], 3 * i);
  }
  geometry.setAttribute("color", new BufferAttribute(colours, 3));
  geometry.computeVertexNormals();
  return new Mesh(geometry, new MeshLambertMaterial({ vertexColors: true, side: DoubleSide }));
}

function trees(world, dark) {
  const group = new Group();
  const count = world.trees.length;
  const crowns = new InstancedMesh(
    new ConeGeometry(1, 1, 6),
    new MeshLambertMaterial({ color: dark ? "#3f6b4c" : "#4d7a50" }),
    count,
  );
  const trunks = new InstancedMesh(
    new CylinderGeometry(0.12, 0.16, 1, 5),
    new MeshLambertMaterial({ color: "#6b5138" }),
    count,
  );
  const still = new Quaternion();
  const matrix = new Matrix4();
  world.trees.forEach(([x, y, base, height, radius], i) => {
    crowns.setMatrixAt(
      i,
      matrix.compose(toThree(x, y, base + height * 0.6), still, new Vector3(radius, height * 0.8, radius)),
    );
    trunks.setMatrixAt(
      i,
      matrix.compose(toThree(x, y, base + height * 0.15), still, new Vector3(radius, height * 0.3, radius)),
    );
  });
  group.add(crowns, trunks);
  return group;
}

/** A flame that flickers and smoke that rises, widens and leans as the world's plume does. */
function fireAt(world, number) {
  const site = world.sites[number];
  const shape = world.fire;
  const group = new Group();
  group.position.copy(toThree(site.x_m, site.y_m, site.z_m));
  const flames = [1, 0.62].map((share, i) => {
    const flame = new Mesh(
      new ConeGeometry(shape.flame_radius_m * share, shape.flame_height_m * share, 10),
      new MeshBasicMaterial({ color: i ? "#ffd45c" : "#f2601d", transparent: true, opacity: 0.9 }),
    );
    flame.position.y = (shape.flame_height_m * share) / 2;
    group.add(flame);
    return flame;
  });
  const beacon = new Mesh(
    new CylinderGeometry(0.7, 0.7, 90, 6),
    new MeshBasicMaterial({ color: "#f2601d", transparent: true, opacity: 0.55 }),
  );
  beacon.position.y = 45;
  group.add(beacon, sign("fire", 94));
  const texture = puff();
  const smoke = Array.from({ length: SMOKE_PUFFS }, () => {
    const sprite = new Sprite(
      new SpriteMaterial({ map: texture, color: "#5a5a5c", transparent: true, depthWrite: false }),
    );
    group.add(sprite);
    return sprite;
  });
  const flicker = (time) => {
    flames.forEach((flame, i) => (flame.scale.y = 1 + 0.14 * Math.sin(5.1 * time + 2 * i)));
    smoke.forEach((sprite, i) => {
      const up = (i / SMOKE_PUFFS + time * 0.05) % 1;
      const radius = shape.flame_radius_m + up * (shape.smoke_top_radius_m - shape.flame_radius_m);
      sprite.position.copy(
        toThree(up * shape.lean_m[0], up * shape.lean_m[1], up * shape.total_height_m + 4),
      );
      sprite.scale.setScalar(2.1 * radius);
      sprite.material.opacity = 0.75 * (1 - up) + 0.1;
    });
  };
  return { node: group, flicker };
}

/** A word that stands `up_m` above its place, of the same size on the screen from wherever it is seen. */
function sign(word, up_m) {
  const canvas = el("canvas", { width: 512, height: 64 });
  const pen = canvas.getContext("2d");
  pen.font = "600 40px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.lineWidth = 8;
  pen.strokeStyle = "rgba(10,14,18,.75)";
  pen.strokeText(word, 256, 46);
  pen.fillStyle = "#ffffff";
  pen.fillText(word, 256, 46);
  const sprite = new Sprite(
    new SpriteMaterial({
      map: new CanvasTexture(canvas),
      sizeAttenuation: false,
      depthTest: false,
      transparent: true,
    }),
  );
  sprite.scale.set(0.32, 0.04, 1);
  sprite.position.y = up_m;
  return sprite;
}

function puff() {
  const canvas = el("canvas", { width: 64, height: 64 });
  const pen = canvas.getContext("2d");
  const shade = pen.createRadialGradient(32, 32, 4, 32, 32, 32);
  shade.addColorStop(0, "rgba(255,255,255,.9)");
  shade.addColorStop(1, "rgba(255,255,255,0)");
  pen.fillStyle = shade;
  pen.fillRect(0, 0, 64, 64);
  return new CanvasTexture(canvas);
}

function stations(world, own) {
  const group = new Group();
  world.base_stations.forEach((station, i) => {
    const mast = new Mesh(
      new CylinderGeometry(0.8, 1.6, 26, 6),
      new MeshLambertMaterial({ color: i === own ? "#f4f6f8" : "#8a8f94" }),
    );
    mast.position.copy(toThree(station.x_m, station.y_m, station.z_m - 13));
    const head = new Mesh(
      new SphereGeometry(i === own ? 3.4 : 2, 12, 8),
      new MeshBasicMaterial({ color: i === own ? "#56b4e9" : "#8a8f94" }),
    );
    head.position.copy(toThree(station.x_m, station.y_m, station.z_m));
    group.add(mast, head);
    if (i === own) {
      const name = sign("remote controller", 0);
      name.position.copy(toThree(station.x_m, station.y_m, station.z_m + 12));
      group.add(name);
    }
  });
  return group;
}

function coldSites(world, burning) {
  const group = new Group();
  world.sites.forEach((site, i) => {
    if (i === burning) return;
    const mark = new Mesh(new TorusGeometry(5, 0.5, 6, 20), new MeshBasicMaterial({ color: "#a0703c" }));
    mark.rotation.x = Math.PI / 2;
    mark.position.copy(toThree(site.x_m, site.y_m, site.z_m + 1));
    group.add(mark);
  });
  return group;
}

function pathOf(mission) {
  const points = mission.path();
  const group = new Group();
  const legs = points.slice(1).map((to, i) => {
    const from = points[i];
    const colour = new Color(shareColour(mission.steps.scs[to.step]).fill);
    const line = new Line2(
      new LineGeometry().setPositions([from, to].flatMap((p) => toThree(p.x, p.y, p.z).toArray())),
      new LineMaterial({ color: colour, linewidth: 4, transparent: true }),
    );
    const stop = new Mesh(
      new SphereGeometry(1.5, 10, 8),
      new MeshBasicMaterial({ color: colour, transparent: true }),
    );
    stop.position.copy(toThree(to.x, to.y, to.z));
    group.add(line, stop);
    return { line, stop };
  });
  return {
    node: group,
    /** What is flown is bright, what is to come faint. */
    until: (step, ended) =>
      legs.forEach(
        ({ line, stop }, i) =>
          (line.material.opacity = stop.material.opacity = i < step || ended ? 1 : i === step ? 0.7 : 0.16),
      ),
  };
}

/** Harmless things that look like fire; the one that the last look took for fire is bright. */
function luresOf(mission) {
  const group = new Group();
  const marks = (mission.data.distractors?.places ?? []).map(([x, y, z, radius]) => {
    const mark = new Mesh(
      new CylinderGeometry(radius, radius, 0.3, 16),
      new MeshBasicMaterial({ color: "#a05fc4", transparent: true, opacity: 0.55 }),
    );
    mark.position.copy(toThree(x, y, z));
    group.add(mark);
    return mark;
  });
  const name = sign("taken for fire", 9);
  name.visible = false;
  group.add(name);
  return {
    node: group,
    mark(look) {
      const at = misleader(mission, look);
      marks.forEach((mark, i) => {
        mark.material.opacity = i === at ? 1 : 0.55;
        mark.material.color.set(i === at ? "#ff4fd8" : "#a05fc4");
      });
      name.visible = at >= 0;
      if (at >= 0) name.position.copy(marks[at].position).add(new Vector3(0, 6, 0));
    },
  };
}

function linkLine() {
  const geometry = new BufferGeometry();
  const position = new BufferAttribute(new Float32Array(6), 3);
  position.setUsage(DynamicDrawUsage);
  geometry.setAttribute("position", position);
  const line = new Line(
    geometry,
    new LineDashedMaterial({ color: "#56b4e9", dashSize: 8, gapSize: 6, transparent: true }),
  );
  line.frustumCulled = false;
  return line;
}

/** Bright while it transmits, and by the rate. */
function moveLink(line, world, mission, pose, time) {
  const station = world.base_stations[mission.data.base_station];
  const position = line.geometry.attributes.position;
  position.setXYZ(0, ...toThree(pose.x, pose.y, pose.z).toArray());
  position.setXYZ(1, ...toThree(station.x_m, station.y_m, station.z_m).toArray());
  position.needsUpdate = true;
  line.computeLineDistances();
  const { steps } = mission;
  const share = steps.rate_bps[mission.stepAt(time)] / Math.max(1, ...steps.rate_bps);
  line.material.opacity = mission.phase(time) === "transmitting" ? 1 : 0.15 + 0.35 * share;
}
