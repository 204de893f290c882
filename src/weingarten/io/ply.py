"""PLY: the vertices of any ascii or binary file, and meshes written with double coordinates.

A header lists elements (vertex, face, …), each with a number of rows and with properties; a property is
a number or a list, a count followed by that many items. Rows follow element after element.
"""

import re
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float64, Int64, UInt8

from weingarten.io.text import table
from weingarten.mesh import Mesh

Points = Float64[np.ndarray, "n 3"]

_MOST_HEADER = 1 << 20
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
_CODES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"int64": "i8", "uint64": "u8", "float": "f4", "double": "f8", "float32": "f4", "float64": "f8"},
}


@dataclass(frozen=True)
class _Property:
    """A column: its name, its numpy code without byte order, and for a list the code of its count."""

    name: str
    code: str
    count: str | None = None


@dataclass(frozen=True)
class _Element:
    """A block of rows."""

    name: str
    rows: int
    properties: tuple[_Property, ...]

    @property
    def has_lists(self) -> bool:
        """Whether rows may differ in length."""
        return any(entry.count for entry in self.properties)

    @property
    def axes(self) -> tuple[int, int, int]:
        """Which properties are x, y and z."""
        names = [None if entry.count else entry.name.lower() for entry in self.properties]
        if not {"x", "y", "z"} <= set(names):
            raise ValueError("its vertices have no properties x, y and z")
        return names.index("x"), names.index("y"), names.index("z")

    def row(self, order: str, lengths: list[int]) -> np.dtype:
        """The record of a row whose lists have these lengths: fields c0 p0 c1 p1 …, c for the counts."""
        fields: list[tuple] = []
        rest = iter(lengths)
        for i, entry in enumerate(self.properties):
            if entry.count:
                fields.append((f"c{i}", order + entry.count))
                fields.append((f"p{i}", order + entry.code, (next(rest),)))
            else:
                fields.append((f"p{i}", order + entry.code))
        return np.dtype(fields)


def read_ply(path: Path) -> Points:
    """x, y and z of the element `vertex`; ValueError for a malformed or truncated file."""
    encoding, elements, start, lines = _header(path)
    names = [element.name for element in elements]
    if "vertex" not in names:
        raise ValueError("it has no vertex element")
    before, vertex = elements[: names.index("vertex")], elements[names.index("vertex")]
    if encoding == "ascii":
        return _ascii(path, vertex, lines + sum(element.rows for element in before), start)
    body = np.memmap(path, np.uint8, "r")
    order = _ORDERS[encoding]
    for element in before:
        _, start = _starts(body, start, element, order)
    return _positions(body, start, vertex, order)


def write_ply(path: Path, mesh: Mesh) -> tuple[str, ...]:
    """Write binary little-endian PLY with double coordinates: the mesh comes back bit for bit. No notes.

    Vertices with a confidence have it as a property of that name, in single precision.
    """
    rows = np.empty(len(mesh.vertices), dtype=[("place", "<f8", (3,))])
    scored = ""
    if mesh.confidence is not None:
        rows = np.empty(len(mesh.vertices), dtype=[("place", "<f8", (3,)), ("confidence", "<f4")])
        rows["confidence"] = mesh.confidence
        scored = "property float confidence\n"
    rows["place"] = mesh.vertices
    header = (
        "ply\nformat binary_little_endian 1.0\ncomment weingarten\n"
        f"element vertex {len(mesh.vertices)}\nproperty double x\nproperty double y\nproperty double z\n"
        f"{scored}element face {len(mesh.faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.empty(len(mesh.faces), dtype=[("count", "u1"), ("corners", "<i4", (3,))])
    faces["count"] = 3
    faces["corners"] = mesh.faces
    with path.open("wb") as stream:
        stream.write(header.encode("ascii"))
        stream.write(rows.tobytes())
        stream.write(faces.tobytes())
    return ()


def _header(path: Path) -> tuple[str, tuple[_Element, ...], int, int]:
    """Encoding, elements, and where the rows start, in bytes and in lines."""
    with path.open("rb") as stream:
        head = stream.read(_MOST_HEADER)
    # the first line's end tells the others': a bare \r at the end of a binary header may be followed by
    # data whose first byte happens to be \n
    first = re.match(rb"ply[ \t]*(\r\n|\n|\r)", head)
    if first is None:
        raise ValueError("it does not start with the word ply")
    newline = re.escape(first[1])
    end = re.search(newline + rb"[ \t]*end_header[ \t]*" + newline, head)
    if end is None:
        raise ValueError("its header has no end_header line")
    text = head[: end.end()].decode("latin-1").split(first[1].decode())
    encoding, elements = None, []
    for line in text[1:-2]:
        words = line.split()
        if words[:1] == ["format"]:
            encoding = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(_property(words))
    if encoding != "ascii" and encoding not in _ORDERS:
        raise ValueError(f"its format {encoding} is unknown")
    if any(rows < 0 for _, rows, _ in elements):
        raise ValueError("its header counts a negative number of rows")
    parsed = tuple(_Element(name, rows, tuple(entries)) for name, rows, entries in elements)
    return encoding, parsed, end.end(), len(text) - 1


def _property(words: list[str]) -> _Property:
    """A `property` line of the header."""
    *types, name = words[1:]
    unknown = [kind for kind in types if kind not in _CODES and kind != "list"]
    if unknown or len(types) not in (1, 3) or (len(types) == 3) != (types[0] == "list"):
        raise ValueError(f"its header line '{' '.join(words)}' is not understood")
    if types[0] == "list":
        return _Property(name, _CODES[types[2]], _CODES[types[1]])
    return _Property(name, _CODES[types[0]])


def _ascii(path: Path, vertex: _Element, skipped: int, start: int) -> Points:
    """The vertices of an ascii file; one row a line."""
    size = path.stat().st_size - start
    if vertex.rows * 2 * len(vertex.properties) > size + 1 or skipped > start + size:
        raise ValueError(f"its header promises {vertex.rows} points, more than the file can hold")
    axes = vertex.axes
    if any(entry.count for entry in vertex.properties[: max(axes)]):
        raise ValueError("its vertices have a list before their coordinates, which is not supported")
    points = table(path, axes, skipped=skipped, rows=vertex.rows, comments=None)
    if len(points) < vertex.rows:
        raise ValueError(f"its header promises {vertex.rows} points and it holds {len(points)}")
    return points


def _positions(body: UInt8[np.ndarray, " b"], start: int, vertex: _Element, order: str) -> Points:
    """The vertices of a binary file whose vertex rows begin at byte `start`."""
    # asked first: rows without properties take no bytes, so any number of them would fit
    axes = vertex.axes
    starts, _ = _starts(body, start, vertex, order)
    points = np.empty((vertex.rows, 3))
    for k, axis in enumerate(axes):
        dtype = np.dtype(order + vertex.properties[axis].code)
        if starts is None:
            row = vertex.row(order, [])
            block = body[start : start + vertex.rows * row.itemsize].view(row)
            points[:, k] = block[f"p{axis}"]
        else:
            values = body[starts[:, axis, None] + np.arange(dtype.itemsize)]
            points[:, k] = values.view(dtype)[:, 0]
    return points


def _starts(
    body: UInt8[np.ndarray, " b"], start: int, element: _Element, order: str
) -> tuple[Int64[np.ndarray, "rows properties"] | None, int]:
    """The byte where each property of each row starts (None without lists: rows are equal), and the end.

    ValueError when the file ends before the element does; asked before anything is allocated.
    """
    least = element.row(order, [0] * len(element.properties)).itemsize
    if start + element.rows * least > len(body):
        held = max(0, len(body) - start) // least
        raise ValueError(
            f"its header promises {element.rows} rows of {element.name}, it holds at most {held}"
        )
    if not element.has_lists or element.rows == 0:
        return None, start + element.rows * least
    row = element.row(order, _lengths(body, start, element, order))
    end = start + element.rows * row.itemsize
    if end <= len(body):
        block = body[start:end].view(row)
        counts = [f"c{i}" for i, entry in enumerate(element.properties) if entry.count]
        if all((block[name] == block[name][0]).all() for name in counts):
            offsets: dict[str, int] = {name: entry[1] for name, entry in (row.fields or {}).items()}
            columns = np.array([offsets[f"p{i}"] for i in range(len(element.properties))])
            return start + np.arange(element.rows)[:, None] * row.itemsize + columns, end
    return _walked(body, start, element, order)


def _lengths(body: UInt8[np.ndarray, " b"], start: int, element: _Element, order: str) -> list[int]:
    """The lengths of the lists in the row that begins at `start`."""
    one = _Element(element.name, 1, element.properties)
    starts, _ = _walked(body, start, one, order)
    lengths = []
    for i, entry in enumerate(element.properties):
        if entry.count:
            dtype = np.dtype(order + entry.count)
            lengths.append(int(body[starts[0, i] - dtype.itemsize : starts[0, i]].view(dtype)[0]))
    return lengths


def _walked(
    body: UInt8[np.ndarray, " b"], start: int, element: _Element, order: str
) -> tuple[Int64[np.ndarray, "rows properties"], int]:
    """`_starts` for rows of differing length, one row after the other."""
    view, size = body.data, len(body)
    steps = []
    for entry in element.properties:
        count = struct.Struct(order + np.dtype(entry.count).char) if entry.count else None
        steps.append((count, np.dtype(entry.code).itemsize))
    starts = np.empty((element.rows, len(steps)), dtype=np.int64)
    at = start
    for row in range(element.rows):
        for column, (count, width) in enumerate(steps):
            items = 1
            if count:
                (items,) = count.unpack_from(view, at)
                at += count.size
            if items < 0 or at + items * width > size:
                raise ValueError(f"its element {element.name} ends or is corrupt in row {row + 1}")
            starts[row, column] = at
            at += items * width
    return starts, at
