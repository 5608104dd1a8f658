// The ground from above, shaded.
import { el } from "./dom.js";

const LIGHT = { x: -0.6, y: 0.6, z: 0.55 }; // from the north-west

/** Shaded ground with its trees, as a picture in a data URL. */
export function relief(world) {
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
  const at = (r, c) =>
    world.height_m[Math.max(0, Math.min(rows - 1, r))][Math.max(0, Math.min(columns - 1, c))];
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
    pen.arc(
      (tx / world.size_m[0]) * canvas.width,
      canvas.height - (ty / world.size_m[1]) * canvas.height,
      Math.max(0.8, (radius / world.size_m[0]) * canvas.width),
      0,
      7,
    );
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
