// The robot with its camera's frustum, and what its LiDARs meet.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  CylinderGeometry,
  DoubleSide,
  DynamicDrawUsage,
  Group,
  Line,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  Points,
  PointsMaterial,
  SphereGeometry,
  TorusGeometry,
  Vector3,
} from "three";
import { toThree } from "./world_axes.js";

const ROBOT_SIZE_M = 7; // across, many times the real one, so that it is seen
const CAMERA_REACH_M = 70;
const MOST_RAYS = 7; // six LiDARs, and the tube ahead
export const NEAR_M = 8; // closer than this a ray is drawn in the colour of danger
export const RAY_COLOURS = { far: "#57b5e8", ahead: "#e69e00", near: "#d6260d" };

export function robotOf(mission) {
  const group = new Group();
  const body = new Group();
  const dark = new MeshLambertMaterial({ color: "#20262b" }),
    blade = new MeshBasicMaterial({ color: "#d55e00", side: DoubleSide, transparent: true, opacity: 0.85 });
  for (const angle of [0.25, 0.75, 1.25, 1.75]) {
    const arm = new Mesh(new CylinderGeometry(0.25, 0.25, ROBOT_SIZE_M / 2, 5), dark);
    arm.rotation.set(Math.PI / 2, 0, angle * Math.PI, "YXZ");
    arm.rotation.set(0, angle * Math.PI, Math.PI / 2);
    arm.position.set(
      (Math.cos(angle * Math.PI) * ROBOT_SIZE_M) / 4,
      0,
      (-Math.sin(angle * Math.PI) * ROBOT_SIZE_M) / 4,
    );
    const rotor = new Mesh(new TorusGeometry(1.5, 0.32, 6, 18), blade);
    rotor.rotation.x = Math.PI / 2;
    rotor.position.set(
      (Math.cos(angle * Math.PI) * ROBOT_SIZE_M) / 2,
      0.3,
      (-Math.sin(angle * Math.PI) * ROBOT_SIZE_M) / 2,
    );
    body.add(arm, rotor);
  }
  body.add(new Mesh(new SphereGeometry(1.4, 12, 8), dark));
  const eye = frustum(mission.data.camera);
  group.add(body, eye);
  return {
    node: group,
    move(pose, phase) {
      group.position.copy(toThree(pose.x, pose.y, pose.z));
      group.rotation.y = pose.yaw;
      eye.rotation.z = -pose.tilt;
      eye.children.forEach(
        (part) => (part.material.opacity = part.userData.opacity * (phase === "sensing" ? 1 : 0.4)),
      );
    },
  };
}

/** Looks along x. */
function frustum({ hfov_deg, aspect }) {
  const half = Math.tan((hfov_deg * Math.PI) / 360) * CAMERA_REACH_M;
  const up = half / aspect;
  const corners = [
    [1, 1],
    [1, -1],
    [-1, -1],
    [-1, 1],
  ].map(([a, b]) => [CAMERA_REACH_M, a * up, b * half]);
  const faces = new BufferGeometry();
  faces.setAttribute(
    "position",
    new BufferAttribute(
      new Float32Array(corners.flatMap((corner, i) => [0, 0, 0, ...corner, ...corners[(i + 1) % 4]])),
      3,
    ),
  );
  const sides = new Mesh(
    faces,
    new MeshBasicMaterial({ color: "#ffd45c", transparent: true, side: DoubleSide, depthWrite: false }),
  );
  sides.userData.opacity = 0.14;
  const edges = new BufferGeometry().setFromPoints(
    corners.flatMap((corner, i) => [
      new Vector3(),
      new Vector3(...corner),
      new Vector3(...corners[(i + 1) % 4]),
      new Vector3(...corner),
    ]),
  );
  const lines = new Line(edges, new LineBasicMaterial({ color: "#f0b030", transparent: true }));
  lines.userData.opacity = 0.9;
  const group = new Group();
  group.add(sides, lines);
  return group;
}

/** A line to each surface that a LiDAR meets within its range at the moment, with a dot where it does. */
export function lidarRays(mission) {
  const ends = new BufferGeometry(),
    lines = new BufferGeometry();
  const attribute = (geometry, name, count) => {
    const made = new BufferAttribute(new Float32Array(3 * count), 3);
    made.setUsage(DynamicDrawUsage);
    geometry.setAttribute(name, made);
    return made;
  };
  const at = attribute(lines, "position", 2 * MOST_RAYS),
    colour = attribute(lines, "color", 2 * MOST_RAYS),
    dot = attribute(ends, "position", MOST_RAYS),
    dotColour = attribute(ends, "color", MOST_RAYS);
  const tones = Object.fromEntries(
    Object.entries(RAY_COLOURS).map(([name, hex]) => [name, new Color(hex).toArray()]),
  );
  const node = new Group();
  node.add(
    new LineSegments(lines, new LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.9 })),
    new Points(ends, new PointsMaterial({ vertexColors: true, size: 6, sizeAttenuation: false })),
  );
  node.children.forEach((part) => (part.frustumCulled = false));
  return {
    node,
    move(pose, time) {
      const rays = mission.lidarAt(time).slice(0, MOST_RAYS);
      const from = toThree(pose.x, pose.y, pose.z).toArray();
      rays.forEach((ray, i) => {
        const to = toThree(ray.x, ray.y, ray.z).toArray();
        const tone = tones[ray.distance < NEAR_M ? "near" : ray.ahead ? "ahead" : "far"];
        at.setXYZ(2 * i, ...from);
        at.setXYZ(2 * i + 1, ...to);
        colour.setXYZ(2 * i, ...tone);
        colour.setXYZ(2 * i + 1, ...tone);
        dot.setXYZ(i, ...to);
        dotColour.setXYZ(i, ...tone);
      });
      lines.setDrawRange(0, 2 * rays.length);
      ends.setDrawRange(0, rays.length);
      for (const changed of [at, colour, dot, dotColour]) changed.needsUpdate = true;
    },
  };
}
