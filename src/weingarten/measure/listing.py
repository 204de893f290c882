"""A measurement as a table for a terminal."""

from collections.abc import Callable
from typing import Any

from weingarten.measure.measurement import Measurement
from weingarten.measure.primitive import Primitive

COLUMNS = ("#", "kind", "side", "size", "extent", "position", "direction", "residual", "share")
RIGHT = {"#", "residual", "share"}

SIZES: dict[str, Callable[[dict[str, Any], Callable[[float], str]], str]] = {
    "plane": lambda row, length: "",
    "sphere": lambda row, length: f"R {length(row['radius'])}",
    "cylinder": lambda row, length: f"R {length(row['radius'])}",
    "cone": lambda row, length: f"half angle {row['half_angle']:.3f}°",
    "torus": lambda row, length: f"R {length(row['major_radius'])}, r {length(row['minor_radius'])}",
}
EXTENTS: dict[str, Callable[[dict[str, Any], Callable[[float], str]], str]] = {
    "plane": lambda row, length: f"{length(row['length'])} × {length(row['width'])}",
    "sphere": lambda row, length: f"{100.0 * row['coverage']:.0f} % of it",
    "cylinder": lambda row, length: f"{length(row['height'])} high, {row['angle']:.0f}°",
    "cone": lambda row, length: (
        f"{length(row['height'])} high, {row['angle']:.0f}°, "
        f"R {length(row['smallest_radius'])} to {length(row['largest_radius'])}"
    ),
    "torus": lambda row, length: f"{row['angle']:.0f}°, tube {row['tube_angle']:.0f}°",
}


def listing(found: Measurement) -> str:
    """Aligned, a line a primitive, lengths to a hundredth of the tolerance; then what is free-form."""
    digits = places(found.tolerance)
    rows = [COLUMNS, *(row(n, one, digits) for n, one in enumerate(found.primitives))]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for cells in rows:
        padded = [
            cell.rjust(width) if head in RIGHT else cell.ljust(width)
            for head, cell, width in zip(COLUMNS, cells, widths, strict=True)
        ]
        lines.append("  ".join(padded).rstrip())
    lines.append(f"Free-form: {100.0 * found.free_share:.1f} % of the area.")
    return "\n".join(lines)


def places(tolerance: float) -> int:
    """Decimal places of a hundredth of a tolerance."""
    digits = 2
    while digits < 12 and tolerance * 10.0**digits < 100.0:
        digits += 1
    return digits


def row(number: int, one: Primitive, digits: int) -> tuple[str, ...]:
    """The cells of one primitive."""
    facts = one.as_dict()

    def length(value: float) -> str:
        return written(value, digits)

    def vector(values: list[float] | None, write: Callable[[float], str]) -> str:
        return "" if values is None else " ".join(write(value) for value in values)

    return (
        str(number),
        one.kind,
        one.side or "",
        SIZES[one.kind](facts, length),
        EXTENTS[one.kind](facts, length),
        vector(facts["position"], length),
        vector(facts.get("axis", facts.get("normal")), lambda value: written(value, 4)),
        f"{one.rms:.1e}",
        f"{100.0 * one.share:.1f} %",
    )


def written(value: float, digits: int) -> str:
    """With so many decimal places, and no sign before a zero."""
    return f"{round(value, digits) + 0.0:.{digits}f}"
