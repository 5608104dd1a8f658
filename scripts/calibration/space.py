"""What the paper leaves open: the parameters that are searched, their ranges, and the world file and keys that a point makes.

A point is a dictionary from a parameter's name to its value. No parameter belongs to one strategy.
"""

import dataclasses
import math

import numpy as np
from scipy.stats import qmc


@dataclasses.dataclass(frozen=True)
class Parameter:
    name: str
    low: float
    high: float
    logarithmic: bool = False
    levels: tuple = ()  # of a reading: values that the unit interval is cut into

    def value(self, unit):
        """From [0, 1) to the parameter's own scale; three digits, so that a file says exactly what flew."""
        if self.levels:
            return self.levels[min(int(unit * len(self.levels)), len(self.levels) - 1)]
        low, high = (math.log(self.low), math.log(self.high)) if self.logarithmic else (self.low, self.high)
        value = low + (high - low) * unit
        return float(f"{math.exp(value) if self.logarithmic else value:.3g}")

    def unit(self, value):
        if self.levels:
            return (self.levels.index(value) + 0.5) / len(self.levels)
        low, high = (math.log(self.low), math.log(self.high)) if self.logarithmic else (self.low, self.high)
        return ((math.log(value) if self.logarithmic else value) - low) / (high - low)


SPACE = (
    # the world
    Parameter("site_distance_m", 60, 200),  # of the nearest sites from the start
    Parameter("site_ring_m", 20, 90),  # from the nearest to the farthest
    Parameter("sight", 0.2, 0.6),  # share of a site's plume in line of sight from around the start
    Parameter("sight_spread", 0.1, 0.3),  # how unlike the sites are in that
    Parameter("start_height_m", 1, 50, True),
    Parameter("start_span_m", 5, 30),
    Parameter("station_distance_m", 15, 130),
    # the detectors
    Parameter("half_signal", 5e-5, 3e-3, True),
    Parameter("quantized_ratio", 1.2, 4.0, True),
    Parameter("slope", 2.0, 8.0),
    Parameter("ceiling", 0.92, 0.99),
    Parameter("view_sigma", 0.1, 1.5),
    Parameter("smoke_weight", 0.1, 2.0, True),
    Parameter("haze_range_m", 150.0, 1500.0, True),
    # what misleads them
    Parameter("distractors_per_km2", 3.0, 200.0, True),
    Parameter("distractor_weight", 0.3, 10.0, True),
    Parameter("distractor_radius_sigma", 0.0, 1.0),
    Parameter("distractor_tilt_deg", 20.0, 80.0),
    Parameter("distractor_tilt_width_deg", 1.0, 15.0),
    Parameter("quantized_gain", 0.3, 3.0, True),
    # a reading
    Parameter("tilt_command", 0, 1, levels=("absolute", "relative")),
)
NAMES = tuple(parameter.name for parameter in SPACE)


def units_of(points):
    """Points as rows of the unit cube."""
    return np.array([[parameter.unit(point[parameter.name]) for parameter in SPACE] for point in points])


def points_of(units):
    return [{parameter.name: parameter.value(u) for parameter, u in zip(SPACE, row)} for row in units]


def space_filling(count, seed):
    return points_of(qmc.LatinHypercube(len(SPACE), seed=seed).random(count))


def settings_of(point):
    """The keys of `ed3r params` that a point sets."""
    half_signal, slope = point["half_signal"], point["slope"]
    return {
        "perception.full.half_signal": half_signal,
        "perception.full.slope": slope,
        "perception.full.ceiling": point["ceiling"],
        "perception.full.view_sigma": point["view_sigma"],
        "perception.quantized.half_signal": float(f"{half_signal * point['quantized_ratio']:.3g}"),
        "perception.quantized.slope": float(f"{0.75 * slope:.3g}"),
        "perception.quantized.ceiling": float(f"{point['ceiling'] - 0.04:.3g}"),
        "perception.quantized.view_sigma": float(f"{1.4 * point['view_sigma']:.3g}"),
        "perception.quantized.distractor_gain": point["quantized_gain"],
        "perception.smoke_weight": point["smoke_weight"],
        "perception.haze_range_m": point["haze_range_m"],
        "perception.distractors_per_km2": point["distractors_per_km2"],
        "perception.distractor_weight": point["distractor_weight"],
        "perception.distractor_radius_sigma": point["distractor_radius_sigma"],
        "perception.distractor_tilt_deg": point["distractor_tilt_deg"],
        "perception.distractor_tilt_width_deg": point["distractor_tilt_width_deg"],
        "agents.tilt_command": point["tilt_command"],
    }


def world_text(point, name, base, about):
    """The world file of a point: terrain, forest and fire of `base`; sites, base stations and start of its own."""
    near, far = point["site_distance_m"], point["site_distance_m"] + point["site_ring_m"]
    sight, spread = point["sight"], point["sight_spread"]
    height, span, station = point["start_height_m"], point["start_span_m"], point["station_distance_m"]
    return f"""# {about}
base: {base}
name: {name}
sites:
  placed:
    seed: 1
    known: 6
    unseen: 8
    distance_m: [{near:g}, {far:g}]
    in_sight: [{max(0.0, sight - spread):.3g}, {min(1.0, sight + spread):.3g}]
    apart_m: 40
base_stations:
  - {{name: BS 1, from_start: {{distance_m: {station:g}, bearing_deg: 134}}, known: true}}
  - {{name: BS 2, from_start: {{distance_m: {station:g}, bearing_deg: 307}}}}
start: {{at_m: [262, 262], radius_m: 15, height_m: [{height:g}, {height + span:g}]}}
"""
