// A mission by time: which timestep, which part of it, where the robot is.

export const EXECUTIONS = ["offload", "full", "quantized"];
export const EXECUTION_LABELS = ["offloaded", "Full, on board", "Quantized, on board"];
export const OUTCOMES = ["success", "false alarm", "battery empty"];

const lastAtOrBefore = (list, value) => {
  let low = 0,
    high = list.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (list[middle] <= value) low = middle;
    else high = middle - 1;
  }
  return low;
};

export function makeMission(data) {
  const { steps, track } = data;
  const count = steps.k.length;
  const met = new Map();
  for (const ray of data.lidar.met) met.set(ray[0], [...(met.get(ray[0]) ?? []), ray]);

  /** Index of the timestep at `time`, from 0. */
  const stepAt = (time) => lastAtOrBefore(steps.begin_s, Math.min(time, data.duration_s));

  const moving = (i) => steps.horizontal_s[i] + steps.ascent_s[i] + steps.descent_s[i] + steps.turning_s[i];

  // A bar's position and a sum of parts are rounded.
  const ended = (time) => time >= data.duration_s - 1e-3;

  /** What the robot does at `time`. */
  function phase(time) {
    if (ended(time)) return "ended";
    const i = stepAt(time);
    let rest = Math.min(time, data.duration_s) - steps.begin_s[i];
    for (const [name, length] of [
      ["flying", moving(i)],
      ["sensing", steps.sensing_s[i]],
      ["computing", steps.computing_s[i]],
      ["transmitting", steps.transmitting_s[i]],
    ]) {
      if (rest < length) return name;
      rest -= length;
    }
    return "transmitting";
  }

  /** Where the robot is; after a timestep's flight the pose that was stored for it. */
  function pose(time) {
    const i = stepAt(time);
    const tilt = steps.tilt_rad[i];
    const stored = { x: steps.x_m[i], y: steps.y_m[i], z: steps.z_m[i], yaw: steps.yaw_rad[i], tilt };
    if (time - steps.begin_s[i] >= moving(i) || track.t_s.length === 0) return stored;
    const j = lastAtOrBefore(track.t_s, time);
    if (track.t_s[j] > time)
      return { x: data.start[0], y: data.start[1], z: data.start[2], yaw: data.start[3], tilt };
    if (j + 1 >= track.t_s.length) return stored;
    const share = Math.min(1, (time - track.t_s[j]) / Math.max(1e-9, track.t_s[j + 1] - track.t_s[j]));
    const mix = (list) => list[j] + share * (list[j + 1] - list[j]);
    let turn = track.yaw_rad[j + 1] - track.yaw_rad[j];
    turn -= 2 * Math.PI * Math.round(turn / (2 * Math.PI));
    return {
      x: mix(track.x_m),
      y: mix(track.y_m),
      z: mix(track.z_m),
      yaw: track.yaw_rad[j] + share * turn,
      tilt,
    };
  }

  /** SCS of the last finished timestep at `time`, null before. */
  const scs = (time) => {
    const i = ended(time) ? count - 1 : stepAt(time) - 1;
    return i < 0 ? null : steps.scs[i];
  };

  /** Index of the last timestep whose camera has looked at `time`, null before the first. */
  const lookedAt = (time) => {
    const i = stepAt(time);
    const looked = time - steps.begin_s[i] >= moving(i) ? i : i - 1;
    return looked < 0 ? null : looked;
  };

  /** What the LiDARs meet within their range at `time`: points {x, y, z, ahead, distance}. */
  function lidarAt(time) {
    if (track.t_s.length === 0) return [];
    const sample = lastAtOrBefore(track.t_s, Math.min(time, data.duration_s));
    const at = [track.x_m[sample], track.y_m[sample], track.z_m[sample]];
    return (met.get(sample) ?? []).map(([, x, y, z, ahead]) => ({
      x,
      y,
      z,
      ahead: ahead === 1,
      distance: Math.hypot(x - at[0], y - at[1], z - at[2]),
    }));
  }

  /** Share of the battery left when the last timestep had ended. */
  const battery = (time) => {
    const i = ended(time) ? count - 1 : stepAt(time) - 1;
    return i < 0 ? 1 : steps.battery_j[i] / data.battery_j;
  };

  /** The flown path as [{x, y, z, step}], through the positions after each timestep. */
  const path = () => [
    { x: data.start[0], y: data.start[1], z: data.start[2], step: -1 },
    ...steps.k.map((_, i) => ({ x: steps.x_m[i], y: steps.y_m[i], z: steps.z_m[i], step: i })),
  ];

  /** The middle of a timestep's look: the robot hovers where the look was taken. */
  const lookTime = (i) => steps.begin_s[i] + moving(i) + steps.sensing_s[i] / 2;

  return {
    data,
    steps,
    count,
    stepAt,
    phase,
    ended,
    pose,
    scs,
    path,
    moving,
    lookedAt,
    lookTime,
    lidarAt,
    battery,
  };
}

const NO_SIGN = 0.0005; // an SCS that is printed as 0.0 %

const percent = (share) => `${(100 * share).toFixed(1)} %`;

/**
 * The looks that decided how the mission ended, as indices: of one that was sure of a fire the last ones above the threshold,
 * of one whose battery was empty the surest, or the last where none saw a sign of fire.
 */
export function decidingLooks({ data, steps, count }) {
  if (count === 0) return [];
  if (data.outcome === 2) {
    const surest = Math.max(...steps.scs);
    return [surest > NO_SIGN ? steps.scs.indexOf(surest) : count - 1];
  }
  let first = count - 1;
  while (first > 0 && first > count - 2 && steps.scs[first - 1] >= data.eta_min) --first;
  return Array.from({ length: count - first }, (_, i) => first + i);
}

/** What the last of the deciding looks is called. */
export function decidingName(mission) {
  const { data, steps } = mission;
  if (data.outcome !== 2) return "the deciding look";
  return Math.max(...steps.scs) > NO_SIGN ? "the surest look" : "the last look";
}

/** Whether the harmless things in view changed a look's score. */
const changed = ({ steps }, i) => {
  const alone = steps.fire_only_scs?.[i];
  return alone !== undefined && alone !== null && Math.abs(alone - steps.scs[i]) >= NO_SIGN;
};

/** Index of the harmless thing that a look took for fire, -1 where none changed its score. */
export const misleader = (mission, look) =>
  look !== null && changed(mission, look) ? (mission.data.distractors?.strongest[look] ?? -1) : -1;

/** What a look would have scored without the harmless things in view; "" where they changed nothing. */
export const misled = (mission, i) =>
  changed(mission, i)
    ? `something harmless in view was taken for fire: without it the SCS would have been ${percent(mission.steps.fire_only_scs[i])}`
    : "";

/** Why the mission ended, as far as its record tells. */
export function endOf({ data, steps, count }) {
  const last = [count - 2, count - 1].filter((i) => i >= 0);
  const looks = last
    .map((i) => `${percent(steps.scs[i])} (fire ${steps.fire_in_view[i] ? "" : "not "}in view)`)
    .join(", then ");
  const reliable = steps.scs.filter((scs) => scs >= data.eta_min).length;
  const threshold = `threshold ${percent(data.eta_min)}`;
  const told = `${last.length > 1 ? "Its last two looks" : "Its only look"}: SCS ${looks}; ${threshold}.`;
  if (data.outcome === 0) return `Ended in success: it was sure of the fire. ${told}`;
  if (data.outcome === 1) {
    const blind = last.every((i) => !steps.fire_in_view[i]);
    const cause = blind
      ? "The fire was in none of these, so that it took something else for one."
      : "The fire was in view, but without what else it took for fire or smoke these looks would not have been sure.";
    const alone = last.map((i) => steps.fire_only_scs?.[i]);
    const without = alone.every((scs) => scs !== undefined && scs !== null)
      ? ` Fire and smoke in view alone would have given ${alone.map(percent).join(", then ")}.`
      : "";
    return `Ended in a false alarm: it was sure of a fire, but what it saw was not the fire. ${told} ${cause}${without}`;
  }
  const sure =
    reliable === 0
      ? `No look of ${count} reached the threshold; the surest had ${percent(Math.max(...steps.scs))}.`
      : `${reliable} of ${count} looks reached the threshold, never enough in a row.`;
  const seen = steps.fire_in_view.filter(Boolean).length;
  const left = percent(steps.battery_j[count - 1] / data.battery_j);
  return `Ended because the battery was empty: the next timestep would have taken more than what was left (${left}), and that ends a mission. ${sure} The fire was in view in ${seen} of ${count}. ${told}`;
}
