// Colours by Okabe and Ito and shades of them, as in the static figures: told apart with any colour vision. Each is a
// pair for light and dark ground.

const ARMS = {
  warmup: ["#7d878e", "#9aa3a9"],
  "warmup-ecd2r": ["#9a8d70", "#c3b8a3"],
  "ed3r-65": ["#2f95d0", "#7cc8f5"],
  "ed3r-75": ["#0072b2", "#3d9fe0"],
  ed3r: ["#0072b2", "#3d9fe0"],
  "ed3r-85": ["#08306b", "#9db8e8"],
  "ablation-1": ["#c78500", "#f0b030"],
  "ablation-2": ["#d55e00", "#f07a2a"],
  "ablation-3": ["#b8558c", "#de90bd"],
  "ablation-4": ["#8c510a", "#c08040"],
  ecd2r: ["#008a64", "#22c096"],
  rbs: ["#4d4d4d", "#c4c8cc"],
};
const OTHERS = ["ed3r-75", "ablation-1", "ecd2r", "ablation-2", "ablation-3", "ed3r-65", "ablation-4", "rbs"];

/** [light, dark] of every arm, in order: the paper's arms have their own, others take theirs in turn. */
export function armColours(names) {
  let taken = 0;
  return names.map((name) => ARMS[name] ?? ARMS[OTHERS[taken++ % OTHERS.length]]);
}

/** Style rules that give each arm its variable; an arm of the same name in a further run is paler. */
export function armRules(names) {
  const seen = new Map();
  const rules = armColours(names).map(([light, dark], i) => {
    const before = seen.get(names[i]) ?? 0;
    seen.set(names[i], before + 1);
    const colour = `light-dark(${light},${dark})`;
    const share = Math.max(35, 100 - 35 * before);
    return `--arm-${i}:${before ? `color-mix(in oklab,${colour} ${share}%,light-dark(#9aa3a9,#5d676e))` : colour}`;
  });
  return `:root{${rules.join(";")}}`;
}

export const OUTCOMES = [
  { id: "0", label: "success", metric: "msr_pct", variable: "--success" },
  { id: "1", label: "false alarm", metric: "fp_pct", variable: "--false-alarm" },
  { id: "2", label: "battery empty", metric: "bd_pct", variable: "--depleted" },
];

// Cividis, sampled: even in lightness, the same for colour-blind readers.
const CIVIDIS = [
  "#00224e",
  "#123570",
  "#3b496c",
  "#575d6d",
  "#707173",
  "#8a8678",
  "#a59c74",
  "#c3b369",
  "#e1cc55",
  "#fee838",
];

/** Relative luminance, as WCAG has it. */
function luminance(parts) {
  const [r, g, b] = parts.map((part) => (part <= 10 ? part / 3294.6 : ((part / 255 + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/** A colour for a share of 0 to 1, and black or white letters for it, whichever reads better. */
export function shareColour(share) {
  const place = Math.max(0, Math.min(1, share)) * (CIVIDIS.length - 1);
  const low = Math.floor(place),
    high = Math.ceil(place);
  const part = (colour, at) => parseInt(colour.slice(at, at + 2), 16);
  const mixed = [1, 3, 5].map((at) =>
    Math.round(part(CIVIDIS[low], at) + (place - low) * (part(CIVIDIS[high], at) - part(CIVIDIS[low], at))),
  );
  const ground = luminance(mixed) + 0.05;
  return { fill: `rgb(${mixed.join(",")})`, ink: ground / 0.05 > 1.05 / ground ? "#000000" : "#ffffff" };
}
