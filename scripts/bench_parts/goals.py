"""The goals, and whether they are met: printed by every run, kept in results/speed.md."""

# What, figure, goal, stretch, whether more is better.
GOALS = [
    ("flights, simulated over processor time, one core, AVX2", "flights avx2: times real time", 25000, 40000, True),
    ("flights, likewise, AVX-512", "flights avx512: times real time", 25000, 40000, True),
    ("training step, AVX2, of the FMA peak", "step avx2: of peak", 0.85, 0.90, True),
    ("training step, AVX-512, of the FMA peak", "step avx512: of peak", 0.85, 0.90, True),
    ("training step, AVX2: time of Eigen with our dropout over ours", "step avx2: Eigen's time", 1.5, 1.5, True),
    ("training step, AVX-512: likewise", "step avx512: Eigen's time", 1.5, 1.5, True),
    ("RC decision, AVX2, of the FMA peak", "decision avx2: of peak", 0.92, 0.95, True),
    ("RC decision, AVX-512, of the FMA peak", "decision avx512: of peak", 0.92, 0.95, True),
    ("RC decision, AVX2: time of the strongest peer over ours", "decision avx2: strongest peer's time", 1.0, 1.0, True),
    ("RC decision, AVX-512: likewise", "decision avx512: strongest peer's time", 1.0, 1.0, True),
    ("paper.yaml, one training seed, two cores: minutes", "paper.yaml min", 8, 5, False),
    ("perception re-scored over flights that exist: times faster than flying", "re-scored: times faster", 50, 50, True),
    ("pixel timestep, 7 of its 33 frames, 192 x 108: ms", "pixel timestep ms", 10, 10, False),
    ("report of 10,000 missions, data: s", "report data s", 1, 1, False),
    ("report of 10,000 missions, with figures: s", "report with figures s", 10, 10, False),
    ("merge of 100,000 missions of 20 timesteps: s", "merge of 100,000 missions s", 20, 20, False),
    ("memory, any number of missions: MB", "memory MB", 150, 150, False),
    ("heap allocations a timestep outside Bullet", "allocations a timestep", 0, 0, False),
]


def verdict(value, goal, stretch, more):
    if value is None:
        return "not measured"
    reached = [value >= bound if more else value <= bound for bound in (goal, stretch)]
    return "stretch met" if all(reached) and goal != stretch else "met" if reached[0] else "not met"


def table(figures):
    lines = ["| what | goal (stretch) | measured | |", "|---|---|---|---|"]
    for what, name, goal, stretch, more in GOALS:
        value = figures.get(name)
        bound = f"{goal:g}" if goal == stretch else f"{goal:g} ({stretch:g})"
        lines.append(f"| {what} | {bound} | {'' if value is None else f'{value:.4g}'} | {verdict(value, goal, stretch, more)} |")
    return "\n".join(lines)
