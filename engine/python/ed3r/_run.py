"""Results of a run directory as arrays."""

import json
import warnings

import numpy as np

from . import _arguments, _core


class Run:
    """A run directory; see the stub."""

    codes = _core.code_names()

    def __init__(self, dir):
        self.dir = _arguments.path("dir", dir)
        self._reader = _core.RunReader(self.dir)
        for note in self._reader.notes:
            warnings.warn(note, stacklevel=2)

    @property
    def name(self):
        return self._reader.name

    @property
    def arms(self):
        return [{"stage": a.stage, "arm": a.arm, "planned": a.planned, "done": a.done, "failed": a.failed}
                for a in self._reader.arms()]

    def missions(self, arm="", *, frame=False):
        return self._table(self._reader.missions(_arguments.text("arm", arm)), frame)

    def steps(self, arm="", *, frame=False):
        return self._table(self._reader.steps(_arguments.text("arm", arm)), frame)

    def report(self):
        return json.loads(self._reader.report_json())

    def digest(self):
        return self._reader.digest()

    def _table(self, columns, frame):
        arms, of = self._reader.arms(), columns.pop("arm")
        stages, names = np.array([a.stage for a in arms]), np.array([a.arm for a in arms])
        columns = {"stage": stages[of], "arm": names[of], **columns}
        if not frame:
            return columns
        import pandas

        return pandas.DataFrame(columns)

    def __repr__(self):
        return f"<ed3r.Run {self.name} in {self.dir}>"
