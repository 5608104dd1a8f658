"""Data sets: pictures as bytes, with labels, in one shape whatever they were read from."""
import csv
import dataclasses
import hashlib
import pathlib

import numpy as np

WIDTH, HEIGHT = 192, 108  # of the frames; a network may look at them made smaller (network.py)

# A frame is positive when the renderer's ground truth says so: one visible pixel of fire or smoke. Frames with fewer
# than these, in the pixels that the network looks at, are left out of training, where a pixel or two teaches noise,
# never out of an evaluation.
FEW_FIRE_PX, FEW_SMOKE_PX = 2, 8


class DataError(Exception):
    """Bad input: one line that says what and where."""


class Frames:
    """Frames of several arrays on disk as one list, read where they are asked for, averaged over shrunk x shrunk pixels."""

    def __init__(self, parts: list[np.ndarray], chosen=None, shrunk=1):
        self.parts, self.shrunk = parts, shrunk
        self.starts = np.cumsum([0] + [len(part) for part in parts])
        self.chosen = np.arange(self.starts[-1]) if chosen is None else chosen

    def __len__(self) -> int:
        return len(self.chosen)

    def __getitem__(self, key) -> np.ndarray:
        numbers = self.chosen[key]
        found = np.empty((len(numbers), *self.parts[0].shape[1:]), np.uint8)
        for part, start, end in zip(self.parts, self.starts, self.starts[1:]):
            inside = (numbers >= start) & (numbers < end)
            if inside.any():
                found[inside] = part[numbers[inside] - start]
        return shrink(found, self.shrunk) if self.shrunk > 1 else found

    def select(self, mask: np.ndarray) -> "Frames":
        return Frames(self.parts, self.chosen[mask], self.shrunk)

    def shrunk_by(self, by: int) -> "Frames":
        return Frames(self.parts, self.chosen, by)


def shrink(frames: np.ndarray, by: int) -> np.ndarray:
    """The mean of each by x by pixels, rounded half up: what engine/perception/vision/resize.h makes of such frames."""
    n, height, width, colours = frames.shape
    sums = frames.reshape(n, height // by, by, width // by, by, colours).sum((2, 4), dtype=np.uint16)
    return ((sums + by * by // 2) // (by * by)).astype(np.uint8)


@dataclasses.dataclass
class DataSet:
    """frames: bytes, row by row; positive: what an evaluation asks for; usable: clear enough to learn from."""

    name: str
    frames: Frames
    positive: np.ndarray
    usable: np.ndarray
    view: np.ndarray  # frames of one view stay together when a set is divided
    columns: dict[str, np.ndarray]
    sha256: str

    def select(self, mask: np.ndarray) -> "DataSet":
        return DataSet(self.name, self.frames.select(mask), self.positive[mask], self.usable[mask], self.view[mask],
                       {key: values[mask] for key, values in self.columns.items()}, self.sha256)

    def shrunk_by(self, by: int) -> "DataSet":
        """The same as a network sees it that looks at frames of so much less width and height."""
        usable = clear(self.columns, by * by) == self.positive if "fire_px" in self.columns else self.usable
        return dataclasses.replace(self, frames=self.frames.shrunk_by(by), usable=usable)

    def __len__(self) -> int:
        return len(self.positive)


def sha256_of(*paths: pathlib.Path) -> str:
    digest = hashlib.sha256()
    for path in paths:
        with open(path, "rb") as file:
            while block := file.read(1 << 20):
                digest.update(block)
    return digest.hexdigest()


def clear(columns: dict[str, np.ndarray], rendered_px: int) -> np.ndarray:
    """Enough fire or smoke to learn from, where a pixel of the network is so many rendered ones."""
    return ((columns["fire_px"] >= FEW_FIRE_PX * rendered_px) | (columns["smoke_px"] >= FEW_SMOKE_PX * rendered_px))


def joined(sets: list[DataSet]) -> DataSet:
    if len(sets) == 1:
        return sets[0]
    together = hashlib.sha256("".join(s.sha256 for s in sets).encode()).hexdigest()
    return DataSet(", ".join(s.name for s in sets), Frames([part for s in sets for part in s.frames.parts]),
                   np.concatenate([s.positive for s in sets]), np.concatenate([s.usable for s in sets]),
                   np.concatenate([np.char.add(f"{i}/", s.view) for i, s in enumerate(sets)]),
                   {key: np.concatenate([s.columns[key] for s in sets]) for key in sets[0].columns}, together)


def read_rendered(folder: pathlib.Path) -> DataSet:
    """A folder of `ed3r frames`."""
    for name in ("frames.npy", "labels.csv"):
        if not (folder / name).is_file():
            raise DataError(f"{folder}: holds no {name}; a folder written by 'ed3r frames' is wanted")
    frames = np.load(folder / "frames.npy", mmap_mode="r")
    if frames.dtype != np.uint8 or frames.shape[1:] != (HEIGHT, WIDTH, 3):
        raise DataError(f"{folder}/frames.npy: {frames.dtype} {frames.shape}; "
                        f"uint8 (n, {HEIGHT}, {WIDTH}, 3) is wanted")
    with open(folder / "labels.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    if len(rows) != len(frames):
        raise DataError(f"{folder}/labels.csv: {len(rows)} rows for {len(frames)} frames")
    for column in ("view", "world", "distance_m", "fire_px", "smoke_px", "occluded", "label"):
        if rows and column not in rows[0]:
            raise DataError(f"{folder}/labels.csv: has no column {column}")
    index = next((column for column in rows[0] if column.lower() == "index"), None) if rows else None
    if index and any(float(row[index]) <= float(above[index]) for above, row in zip(rows, rows[1:])):
        raise DataError(f"{folder}/labels.csv: its rows are not in the order of their frames, each once; "
                        "sort them by index")
    number = {key: np.array([float(row[key]) for row in rows]) for key in ("distance_m", "fire_px", "smoke_px",
                                                                         "occluded", "label")}
    if not np.isin(number["label"], (0, 1)).all():
        raise DataError(f"{folder}/labels.csv: a label is neither 0 nor 1")
    positive = number["label"] == 1
    world = np.array([row["world"] for row in rows])
    view = np.array([f"{row['world']}/{row['view']}" for row in rows])
    return DataSet(str(folder), Frames([frames]), positive, clear(number, 1) == positive, view,
                   {**number, "world": world}, sha256_of(folder / "frames.npy", folder / "labels.csv"))


def read_dfire(folder: pathlib.Path) -> DataSet:
    """D-Fire's layout: images/*.jpg|png and labels/*.txt with 'class x y width height' lines; 0 smoke, 1 fire.

    A picture with any box is positive; an empty or missing label file means none. Pictures are shrunk to the networks'
    size, proportions not kept, as the engine does with foreign pictures.
    """
    from PIL import Image

    pictures = sorted(p for p in (folder / "images").glob("*") if p.suffix.lower() in {".jpg", ".jpeg", ".png"})
    if not pictures:
        raise DataError(f"{folder}: holds no pictures in images/; D-Fire's layout is images/ and labels/")
    frames, smoke, fire, files = [], [], [], []
    for picture in pictures:
        try:
            with Image.open(picture) as image:
                frames.append(np.asarray(image.convert("RGB").resize((WIDTH, HEIGHT), Image.Resampling.BOX)))
        except OSError as error:
            raise DataError(f"{picture}: is no picture: {error}") from error
        label = folder / "labels" / (picture.stem + ".txt")
        classes = _classes(label) if label.is_file() else set()
        smoke.append(0 in classes)
        fire.append(1 in classes)
        files += [picture] + ([label] if label.is_file() else [])
    positive = np.array(smoke) | np.array(fire)
    unknown = np.full(len(frames), np.nan)
    columns = {"distance_m": unknown, "occluded": unknown, "smoke": np.array(smoke), "fire": np.array(fire),
               "world": np.array(["dfire"] * len(frames))}
    return DataSet(str(folder), Frames([np.stack(frames)]), positive, np.ones(len(frames), bool),
                   np.array([p.stem for p in pictures]), columns, sha256_of(*files))


def _classes(label: pathlib.Path) -> set[int]:
    found = set()
    for number, line in enumerate(label.read_text(encoding="utf-8").splitlines(), 1):
        if not line.strip():
            continue
        words = line.split()
        try:
            kind, box = int(words[0]), [float(word) for word in words[1:]]
        except ValueError:
            kind, box = -1, []
        if kind not in (0, 1) or len(box) != 4:
            raise DataError(f"{label}:{number}: '{line.strip()}'; 'class x y width height' with class 0 (smoke) or "
                            "1 (fire) is wanted")
        found.add(kind)
    return found


def divide(data: DataSet, share: float, seed: int) -> tuple[DataSet, DataSet]:
    """(rest, share): whole views, drawn by a hash of seed and view, so that no view is on both sides."""

    def drawn(view: str) -> bool:
        return int(hashlib.sha256(f"{seed} {view}".encode()).hexdigest()[:8], 16) < share * 2**32

    chosen = {view: drawn(view) for view in np.unique(data.view)}
    mask = np.array([chosen[view] for view in data.view])
    return data.select(~mask), data.select(mask)
