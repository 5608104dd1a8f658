// One clock for all missions on the page: mission time in seconds, played at a chosen speed.

export function makeClock(
  end,
  { now = () => performance.now(), frame = (tick) => requestAnimationFrame(tick) } = {},
) {
  let time = 0,
    playing = false,
    speed = 10,
    last = 0;
  const listeners = [];
  const tell = () => listeners.forEach((listener) => listener(time, playing));
  const tick = () => {
    if (!playing) return;
    const here = now();
    time = Math.min(end, time + ((here - last) / 1000) * speed);
    last = here;
    if (time >= end) playing = false;
    tell();
    if (playing) frame(tick);
  };
  return {
    end,
    time: () => time,
    playing: () => playing,
    speed: () => speed,
    listen: (listener) => listeners.push(listener),
    set(to) {
      time = Math.max(0, Math.min(end, to));
      tell();
    },
    setSpeed(to) {
      speed = to;
    },
    toggle() {
      playing = !playing;
      if (playing) {
        if (time >= end) time = 0;
        last = now();
        frame(tick);
      }
      tell();
    },
  };
}
