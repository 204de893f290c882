"""Tables of numbers as text: XYZ, TXT, CSV; also the number columns inside ASCII PLY, PCD, OBJ and STL.

Fields are split by white space, commas or semicolons; `#` starts a comment; one header line may come
first. With semicolons a comma inside a field is a decimal comma.
"""

import re
from collections.abc import Iterable
from io import StringIO
from pathlib import Path

import numpy as np
from jaxtyping import Float64

Points = Float64[np.ndarray, "n 3"]

_SNIFFED = 1 << 16


def read_text(path: Path) -> Points:
    """The columns named x, y, z in the header line, or else the first three; ValueError for no such table."""
    with path.open("rb") as stream:
        head = stream.read(_SNIFFED)
    if b"\0" in head:
        raise ValueError("it holds binary data instead of text")
    encoding = "utf-8-sig" if head.startswith(b"\xef\xbb\xbf") else "latin-1"
    lines = list(StringIO(head.decode(encoding, errors="replace"), newline=None))
    skipped, delimiter, columns, decimal_comma = _layout(lines)
    if decimal_comma:
        with path.open(encoding=encoding) as stream:
            rows = (line.replace(",", ".") for line in stream)
            return table(rows, columns, skipped=skipped, delimiter=delimiter)
    return table(path, columns, skipped=skipped, delimiter=delimiter, encoding=encoding)


def table(
    source: Path | Iterable[str],
    columns: tuple[int, int, int] = (0, 1, 2),
    *,
    skipped: int = 0,
    rows: int | None = None,
    delimiter: str | None = None,
    comments: str | None = "#",
    encoding: str = "latin-1",
) -> Points:
    """Three columns of a text table, parsed to the nearest float64; ValueError names the row that fails."""
    return np.loadtxt(
        str(source.resolve()) if isinstance(source, Path) else source,
        dtype=np.float64,
        comments=comments,
        delimiter=delimiter,
        skiprows=skipped,
        usecols=columns,
        max_rows=rows,
        ndmin=2,
        encoding=encoding,
    )


def _layout(lines: list[str]) -> tuple[int, str | None, tuple[int, int, int], bool]:
    """Lines to skip, delimiter, columns, and whether commas are decimal, from a table's first lines."""
    content = [(i, text) for i, line in enumerate(lines) if (text := line.split("#", 1)[0].strip())]
    if not content:
        raise ValueError("it holds no points")
    numbers = _number_of_columns(content[0][1])
    # a lone number is the count of rows, with which some scanners begin
    has_header = numbers == 0 or content[0][1].isdecimal()
    if (numbers < 3 and not has_header) or (has_header and len(content) == 1):
        raise ValueError("its first row is not three numbers")
    skipped = content[0][0] + 1 if has_header else 0
    first = content[1][1] if has_header else content[0][1]
    delimiter = _delimiter(first)
    columns = _named_columns(content[0][1], len(first.split(delimiter)), delimiter)
    return skipped, delimiter, columns, delimiter == ";" and "," in first


def _delimiter(line: str) -> str | None:
    """What splits a line's fields; None for white space."""
    return next((sign for sign in ";," if sign in line), None)


def _number_of_columns(line: str) -> int:
    """How many of a line's leading fields are numbers."""
    delimiter = _delimiter(line)
    fields = line.replace(",", ".").split(delimiter) if delimiter == ";" else line.split(delimiter)
    for number, field in enumerate(fields):
        try:
            float(field)
        except ValueError:
            return number
    return len(fields)


def _named_columns(header: str, width: int, delimiter: str | None) -> tuple[int, int, int]:
    """Where a header line has the names x, y, z; the first three columns when it does not tell."""
    names = [re.sub(r"[\"'/\s]", "", name).lower() for name in header.split(delimiter)]
    if len(names) == width and all(names.count(axis) == 1 for axis in "xyz"):
        return names.index("x"), names.index("y"), names.index("z")
    return 0, 1, 2
