"""Inputs, stores and places as nobody should make them: one line and the right status, or the same results as ever."""

from . import odd_places, odd_stores, odd_sweeps


def run(trial, large, options):
    for part in (odd_sweeps, odd_stores, odd_places):
        part.run(trial, large)
