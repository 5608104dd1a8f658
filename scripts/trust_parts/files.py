"""Files that people give, changed as spreadsheets, GIS programs, loggers and exporters change them: the same numbers, or one line.

Each try makes one small file with numbers of its own, changes it, reads the changed bytes by a plain reader of this part, and
asks the program what it makes of them. A file that says the same otherwise, and one that says other sensible numbers, gives exactly
these or is refused (the same written otherwise only as files_refusals.py knows); where the plain reader finds nothing sensible it must be refused. A fault is another number, a refusal in more
or less than one line or with another status than 2, a crash, a hang, more than 6 GB of addresses. The files of a fault are
kept; a try depends on the seed, its kind and its number alone: --only KIND/NUMBER does it again.
"""

import random
import resource
import shutil
import tempfile

from . import files_frames, files_grids, files_logs, files_refusals, files_settings, files_stems

KINDS = {**files_grids.KINDS, **files_stems.KINDS, **files_logs.KINDS, **files_frames.KINDS, **files_settings.KINDS}
ADDRESSES = 6 << 30  # the program maps 1 GB where it uses a tenth of that


class Try:
    """A folder, a generator, and the judge of what the program says of the file in it."""

    def __init__(self, trial, kind, number, seed):
        self.trial, self.kind = trial, kind
        self.name = f"{kind}/{number}"
        self.random = random.Random(f"{seed} {kind} {number}")
        self.folder = trial.fresh("file")
        self.folder.mkdir()
        self.failed, self.done, self.arguments = False, "", ()
        self.otherwise = ()  # what was written otherwise, where nothing else happened to the file

    def write(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def ed3r(self, *arguments):
        self.arguments = arguments
        return self.trial.ed3r(*arguments, cwd=self.folder, limits={resource.RLIMIT_AS: ADDRESSES})

    def fault(self, what):
        kept = ""
        if not self.failed:
            kept = tempfile.mkdtemp(prefix="ed3r-trust-files-kept-")
            shutil.copytree(self.folder, kept, dirs_exist_ok=True, symlinks=True)
            kept = f"; in {kept}: ed3r {' '.join(map(str, self.arguments))}"
        self.failed = True
        self.trial.fault(f"{self.name}, {self.done}", what + kept)

    def judge(self, done, said, read, wanted, unlike):
        """`read()`: the numbers that the program told; `wanted`: the plain reader's, or why there are none sensible, as a text;
        `unlike(read, wanted)`: how they differ, or ''."""
        self.done = done
        if said.fault():
            return self.fault(said.fault())
        if said.status != 0:
            if said.status != 2:
                return self.fault(f"not refused as bad input: {said}")
            return self.refused(said, wanted)
        if isinstance(wanted, str):
            return self.fault(f"taken, though {wanted}")
        try:
            difference = unlike(read(), wanted)
        except (ValueError, KeyError, IndexError, OSError) as error:
            difference = f"what it says cannot be read: {error!r}"
        if difference:
            return self.fault(f"another number: {difference}")
        self.trial.count(f"{self.kind} read rightly")
        return None

    def refused(self, said, wanted):
        """Whether what says the same was refused for a known way of writing."""
        if not self.otherwise or isinstance(wanted, str):
            return self.trial.count(f"{self.kind} refused")
        way = files_refusals.known(self.kind, said.err.strip())
        if not way:
            self.fault(f"refused, though it says the same ({', '.join(self.otherwise)}): {said}")
        return self.trial.count(f"{self.kind} refused for {way or 'no known way of writing'}")


def run(trial, large, options):
    if options.only:
        kind, number = options.only.split("/")
        KINDS[kind](one := Try(trial, kind, int(number), options.seed))
        print(f"trust files: {one.name}: {one.done}")
        return
    tries = options.tries or (150 if large else 3)
    for number in range(tries):
        for kind, function in KINDS.items():
            function(one := Try(trial, kind, number, options.seed))
            trial.discard(one.folder)
