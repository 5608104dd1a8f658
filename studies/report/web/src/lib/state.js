// What the reader has chosen, and its form in the URL's fragment: only what differs from the start is written.

export const START = Object.freeze({
  arms: [], // keys; none: all
  site: "all", // or "known", "unseen", a number as text
  outcome: "all", // or 0, 1, 2 as text
  scale: "energy_kj", // of the distributions
  sort: "", // of the headline table: METRIC or -METRIC
  verdict: "all",
  about: "all", // metric of claims
  sure: "all",
  find: "", // text in a claim
  theme: "auto",
});

/** Unknown keys are dropped; `allowed` maps a key to a test of its value. */
export function parseFragment(fragment, allowed = {}) {
  const state = { ...START };
  for (const [key, text] of new URLSearchParams(fragment.replace(/^#/, ""))) {
    if (!Object.hasOwn(START, key)) continue;
    const value = key === "arms" ? text.split("~").filter((arm) => !allowed.arm || allowed.arm(arm)) : text;
    if (key !== "arms" && allowed[key] && !allowed[key](value)) continue;
    state[key] = value;
  }
  return state;
}

export function writeFragment(state) {
  const parts = new URLSearchParams();
  for (const [key, start] of Object.entries(START)) {
    const value = key === "arms" ? state.arms.join("~") : state[key];
    if (value !== (key === "arms" ? "" : start)) parts.set(key, value);
  }
  return parts.toString();
}

/** Tells every listener of a change; the fragment follows. */
export function makeStore(initial, onChange) {
  let state = initial;
  const listeners = [];
  return {
    get: () => state,
    listen: (listener) => listeners.push(listener),
    set(change) {
      state = { ...state, ...change };
      onChange(state);
      for (const listener of listeners) listener(state);
    },
    /** Adds the arm to those chosen, or takes it away. */
    toggleArm(key) {
      const { arms } = state;
      this.set({ arms: arms.includes(key) ? arms.filter((arm) => arm !== key) : [...arms, key] });
    },
    /** Chooses a value of `key`, or gives it up where it is chosen already. */
    toggle(key, value) {
      this.set({ [key]: state[key] === value ? START[key] : value });
    },
  };
}
