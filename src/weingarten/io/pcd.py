"""PCD, the Point Cloud Library's format: ascii, binary and binary_compressed.

Header: FIELDS names the columns; SIZE, TYPE (F I U) and COUNT describe each of them; POINTS (or WIDTH
times HEIGHT) counts the rows; DATA ends it and names the encoding. Binary data are little endian; the
compressed ones are stored field after field. VIEWPOINT is the sensor's pose and moves no point.
"""

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from weingarten.io.lzf import lzf_decoded
from weingarten.io.text import table

Points = Float64[np.ndarray, "n 3"]

_MOST_HEADER = 1 << 20
_LZF_EXPANSION = 90


@dataclass(frozen=True)
class _Header:
    """What a PCD header says; `start` and `lines` are where the data begin, in bytes and in lines."""

    fields: tuple[str, ...]
    dtypes: tuple[str, ...]
    counts: tuple[int, ...]
    points: int
    encoding: str
    start: int
    lines: int

    @property
    def row(self) -> np.dtype:
        """One point's record; fields are numbered, since names such as `_` may repeat."""
        pairs = zip(self.dtypes, self.counts, strict=True)
        return np.dtype([(f"f{i}", kind, (count,)) for i, (kind, count) in enumerate(pairs)])

    @property
    def axes(self) -> tuple[int, int, int]:
        """Which fields are x, y and z."""
        x, y, z = (self.fields.index(axis) if axis in self.fields else -1 for axis in "xyz")
        if min(x, y, z) < 0 or min(self.counts[i] for i in (x, y, z)) < 1:
            raise ValueError("its header does not name the fields x, y and z")
        return x, y, z


def read_pcd(path: Path) -> Points:
    """The fields x, y, z of every point; ValueError for a malformed or truncated file."""
    header = _header(path)
    size = path.stat().st_size - header.start
    if header.encoding == "ascii":
        return _ascii(path, header, size)
    if header.encoding == "binary":
        return _binary(path, header, size)
    if header.encoding == "binary_compressed":
        return _compressed(path, header, size)
    raise ValueError(f"its data encoding {header.encoding} is unknown")


def _ascii(path: Path, header: _Header, size: int) -> Points:
    least = 2 * sum(header.counts)
    if header.points * least > size + 1:
        raise ValueError(f"its header promises {header.points} points, more than the file can hold")
    starts = np.cumsum([0, *header.counts])
    x, y, z = (int(starts[i]) for i in header.axes)
    points = table(path, (x, y, z), skipped=header.lines, rows=header.points)
    if len(points) < header.points:
        raise ValueError(f"its header promises {header.points} points and it holds {len(points)}")
    return points


def _binary(path: Path, header: _Header, size: int) -> Points:
    if header.points * header.row.itemsize > size:
        held = size // header.row.itemsize
        raise ValueError(f"its header promises {header.points} points and it holds {held}")
    axes = header.axes
    rows = np.memmap(path, np.uint8, "r", header.start, (header.points * header.row.itemsize,))
    rows = rows.view(header.row)
    return np.stack([rows[f"f{i}"][:, 0].astype(np.float64) for i in axes], axis=1)


def _compressed(path: Path, header: _Header, size: int) -> Points:
    with path.open("rb") as stream:
        stream.seek(header.start)
        packed, unpacked = struct.unpack("<II", stream.read(8))
        if packed > size - 8:
            raise ValueError(f"it promises {packed} compressed bytes and holds {size - 8}")
        if unpacked != header.points * header.row.itemsize or unpacked > packed * _LZF_EXPANSION:
            raise ValueError(f"its compressed size does not fit its {header.points} points")
        data = lzf_decoded(stream.read(packed), unpacked)
    offsets: dict[str, int] = {name: entry[1] for name, entry in (header.row.fields or {}).items()}
    columns = []
    for axis in header.axes:
        shape = (header.points, header.counts[axis])
        column = np.ndarray(shape, header.dtypes[axis], data, offsets[f"f{axis}"] * header.points)
        columns.append(column[:, 0].astype(np.float64))
    return np.stack(columns, axis=1)


def _header(path: Path) -> _Header:
    """Parse the header; ValueError when it is missing, incomplete or contradicts itself."""
    entries: dict[str, list[str]] = {}
    lines = 0
    with path.open("rb") as stream:
        while "DATA" not in entries:
            raw = stream.readline(_MOST_HEADER)
            lines += 1
            if not raw or stream.tell() > _MOST_HEADER:
                raise ValueError("its header has no DATA line")
            words = raw.decode("latin-1").split("#", 1)[0].split()
            if words:
                entries[words[0].upper()] = words[1:]
        start = stream.tell()
    fields = tuple(name.lower() for name in entries.get("FIELDS", entries.get("COLUMNS", [])))
    sizes, types = entries.get("SIZE", []), entries.get("TYPE", [])
    counts = tuple(int(count) for count in entries.get("COUNT", ["1"] * len(fields)))
    if not len(fields) == len(sizes) == len(types) == len(counts) or not fields or min(counts) < 0:
        raise ValueError("its FIELDS, SIZE, TYPE and COUNT lines do not fit together")
    kinds = {"F": "f", "I": "i", "U": "u"}
    dtypes = tuple(f"<{kinds[kind.upper()]}{int(size)}" for kind, size in zip(types, sizes, strict=True))
    if "POINTS" in entries:
        points = int(entries["POINTS"][0])
    else:
        points = int(entries["WIDTH"][0]) * int(entries["HEIGHT"][0])
    if points < 1:
        raise ValueError("it holds no points")
    return _Header(fields, dtypes, counts, points, entries["DATA"][0].lower(), start, lines)
