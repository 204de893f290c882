"""The figures of a fit, each with its unit and what it says; its settings; and where it comes from."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from weingarten.report.facts import LABELS, in_words, version
from weingarten.report.run.colours import digits
from weingarten.report.run.source import Run
from weingarten.settings import PRESETS

LENGTH, VOLUME, SHARE = "u", "u³", "%"
UNDEFINED = "not defined"
EMPTY = "–"


@dataclass(frozen=True)
class Figure:
    """A figure as a page shows it."""

    label: str
    text: str
    unit: str
    meaning: str


@dataclass(frozen=True)
class Setting:
    """changed: whether it is other than the preset has it; usual: what the preset has then."""

    label: str
    text: str
    changed: bool
    usual: str


def count(value: Any) -> str:
    """1,234"""
    return f"{int(value):,}"


def length(value: Any) -> str:
    """Four digits."""
    return digits(float(value), 4)


def percent(value: Any) -> str:
    """Of a share from 0 to 1."""
    return f"{100 * float(value):.2f}"


def yes_or_no(value: Any) -> str:
    """In words."""
    return "yes" if value else "no"


FIGURES: dict[str, tuple[str, str, Callable[[Any], str], str]] = {
    "points": ("points", "", count, "in the cloud, without repeated ones and outliers that were left out"),
    "diagonal": ("diagonal of the cloud", LENGTH, length, "of its box, from corner to corner"),
    "vertices": ("vertices", "", count, "corners of the mesh’s triangles"),
    "faces": ("triangles", "", count, "of the mesh"),
    "watertight": ("watertight", "", yes_or_no, "every edge joins exactly two triangles: nothing leaks"),
    "components": ("pieces", "", count, "that are not joined to each other"),
    "genus": ("genus", "", count, "through-holes and handles, of all pieces together"),
    "self_intersecting": ("crossing triangles", "", count, "that pass through others; none in a clean solid"),
    "volume": ("volume", VOLUME, length, "that the mesh encloses"),
    "distance_mean": ("mean distance", LENGTH, length, "of the points from the mesh, without sign"),
    "distance_p95": ("95 % within", LENGTH, length, "that distance of the mesh lie 95 % of the points"),
    "distance_max": ("farthest point", LENGTH, length, "the greatest distance of a point from the mesh"),
    "guessed": ("guessed surface", SHARE, percent, "of the mesh’s area is far from all points"),
    "missed": ("missed points", SHARE, percent, "of the points are far from the mesh, for their spacing"),
    "steps": ("steps taken", "", count, "of the optimisation"),
    "of_steps": ("steps planned", "", count, "of the optimisation"),
    "finished": ("finished", "", yes_or_no, "all planned steps were taken, or it was told to stop early"),
    "loss": ("last loss", "", length, "of the last step; it can only be compared under equal weights"),
}
"""By the summary's name: label, unit, how it is written, and what it says."""


def figures(summary: dict[str, Any]) -> list[Figure]:
    """Every figure of a summary."""
    found = []
    for key, (label, unit, write, meaning) in FIGURES.items():
        if key in summary:
            value = summary[key]
            text = UNDEFINED if value is None else write(value)
            found.append(Figure(label, text, "" if value is None else unit, meaning))
    return found


def settings(values: dict[str, Any]) -> list[Setting]:
    """Every setting, those first that differ from the preset's."""
    preset = PRESETS.get(str(values.get("preset")))
    usual = {} if preset is None else preset.as_dict()
    rows = []
    for key, value in values.items():
        changed = key in usual and usual[key] != value
        before = in_words(key, usual[key]) or EMPTY if changed else ""
        rows.append(Setting(LABELS.get(key, key), in_words(key, value) or EMPTY, changed, before))
    return sorted(rows, key=lambda row: not row.changed)


def origin(run: Run) -> list[tuple[str, str]]:
    """Name and value of what is known of where a fit comes from."""
    made = run.made
    rows = [
        ("Cloud", made.get("cloud")),
        ("Mesh", made.get("mesh")),
        ("weingarten", version(made)),
        ("Device", made.get("device")),
        ("Machine", made.get("machine")),
        ("Fitted", made.get("date")),
    ]
    return [(name, str(value)) for name, value in rows if value]


def primitives(rows: list[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    """Keys of any primitive in the order of their first, and a row a primitive."""
    keys = list(dict.fromkeys(key for row in rows for key in row))
    return [key.replace("_", " ") for key in keys], [[plain(row.get(key)) for key in keys] for row in rows]


def plain(value: Any) -> str:
    """Any JSON value in words."""
    match value:
        case None:
            return EMPTY
        case bool():
            return yes_or_no(value)
        case int():
            return f"{value:,}"
        case float():
            return digits(value, 5)
        case list():
            return ", ".join(map(plain, value))
        case dict():
            return "; ".join(f"{key} {plain(one)}" for key, one in value.items())
        case _:
            return str(value)
