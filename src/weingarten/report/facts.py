"""What was compared, under which conditions, what failed and what is odd: from the records of the fits."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from weingarten.bench.job import DONE
from weingarten.bench.results import Result

TRUTH = "truth-"
MEANINGS = {
    "open": "not closed: no volume, no inside",
    "not-oriented": "faces disagree on which side is outside",
    "no-volume": "closed, but encloses nothing",
    "inside-out": "inside out; taken for its inside all the same",
    "bodies": "several separate surfaces",
    "degenerate-faces": "faces without area, left out",
    "size-mismatch": "sizes of mesh and truth differ by more than a factor of three",
    "boxes-apart": "boxes of mesh and truth do not meet",
    "field-not-finite": "the field is not finite everywhere",
}
"""What flags say, without the role that they begin with; see `weingarten.metrics.findings`."""
LABELS = {
    "points": "points per step",
    "term": "scheduled term",
    "shape": "schedule",
    "knots": "weight, t : w",
    "stencil": "stencil, t : h",
    "sharp": "sharp edges",
    "trim": "greatest distance from the points",
    "simplify": "moved for fewer triangles",
    "rate": "learning rate",
    "decay": "decay of the rate",
    "ramp": "points, first and last step",
    "clip": "greatest gradient",
    "resolution": "cells along the longest side",
    "oracle": "stopped by the truth",
}
"""Settings whose names do not speak for themselves."""
NONE = "–"
NEURAL = "neural"
"""The kind of contenders whose settings have no prefix."""


@dataclass(frozen=True)
class Failure:
    """Why fits failed, and which."""

    sentence: str
    fits: tuple[str, ...]


@dataclass(frozen=True)
class Flag:
    """Something odd, what it means, and where it was found."""

    name: str
    meaning: str
    where: tuple[str, ...]


@dataclass(frozen=True)
class Settings:
    """common: name and value of what all contenders that have it agree in. differing: a row a contender."""

    common: tuple[tuple[str, str], ...]
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Facts:
    """sentence: the benchmark in one. conditions: name and value. Of the settings, see there."""

    sentence: str
    conditions: tuple[tuple[str, str], ...]
    settings: Settings
    failures: tuple[Failure, ...]
    flags: tuple[Flag, ...]
    unjudged: int


def facts(found: Sequence[Result], parts: Sequence[str], names: Sequence[str]) -> Facts:
    """Everything the records say of a benchmark. parts, names: of parts and contenders, in order."""
    failed = [one for one in found if one.failed]
    unjudged = sum(bool(one.error) for one in found) - len(failed)
    return Facts(
        sentence=sentence(found, parts, names, len(failed), unjudged),
        conditions=conditions(found),
        settings=settings(found, names),
        failures=failures(failed),
        flags=flags(found, names),
        unjudged=unjudged,
    )


def sentence(
    found: Sequence[Result], parts: Sequence[str], names: Sequence[str], failed: int, unjudged: int
) -> str:
    """How many of what."""
    seeds = sorted({one.seed for one in found})
    seeded = f"seed {seeds[0]}" if len(seeds) == 1 else f"seeds {listed(map(str, seeds))}"
    said = (
        f"{counted(len(names), 'contender')} on {counted(len(parts), 'part')}, {seeded}: "
        f"{counted(len(found), 'fit')}"
    )
    said += f", {failed} of them failed" if failed else ", none failed"
    return said + (f", {unjudged} not compared with the truth yet." if unjudged else ".")


def counted(number: int, thing: str) -> str:
    """1 fit, 2 fits."""
    return f"{number:,} {thing}{'' if number == 1 else 's'}"


def listed(words: Iterable[str]) -> str:
    """a, b and c."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def conditions(found: Sequence[Result]) -> tuple[tuple[str, str], ...]:
    """Scan, machine, versions and time; several values, the most frequent first, where fits differ."""
    seconds = sum(float(one.fit.get("seconds") or 0.0) for one in found)
    rows = [
        ("Scan", several(scan_in_words(one.fit.get("scan") or {}) for one in found)),
        ("Device", several(one.fit.get("device") for one in found)),
        ("Machine", several(one.fit.get("machine") for one in found)),
        ("weingarten", several(version(one.fit) for one in found)),
        ("Fitted", period(sorted({str(one.fit["date"]) for one in found if one.fit.get("date")}))),
        ("Time", f"{seconds / 3600:.1f} h in all" if seconds >= 5400 else f"{seconds / 60:.0f} min in all"),
    ]
    return tuple((name, value) for name, value in rows if value)


def several(values: Iterable[str | None]) -> str:
    """The distinct values, with how often each comes where there are several."""
    counts = Counter(str(value) for value in values if value)
    if len(counts) == 1:
        return next(iter(counts))
    return "; ".join(f"{value} ({counted(count, 'fit')})" for value, count in counts.most_common())


def scan_in_words(scan: dict[str, Any]) -> str:
    """What was fitted to."""
    if "points" in scan:
        return f"{scan['points']:,} points sampled from the truth"
    return "the part's own cloud" if "cloud" in scan else ""


def version(fit: dict[str, Any]) -> str:
    """Of the package, and its commit."""
    return " ".join(
        str(fit[key]) if key == "version" else f"({fit[key]})"
        for key in ("version", "commit")
        if fit.get(key)
    )


def period(dates: Sequence[str]) -> str:
    """From the first to the last."""
    return " to ".join(dict.fromkeys([*dates[:1], *dates[-1:]]))


def settings(found: Sequence[Result], names: Sequence[str]) -> Settings:
    """What the contenders have in common, and in what they differ."""
    own: dict[str, dict[str, str]] = {name: {} for name in names}
    for one in found:
        kept = one.fit.get("settings") or {}
        kind = kept.get("kind", NEURAL)
        for key, value in kept.items():
            its = key if kind == NEURAL or key in ("kind", "oracle") else f"{kind} {key}"
            own[one.contender].setdefault(its, in_words(key, value) or NONE)
    keys = list(dict.fromkeys(key for values in own.values() for key in values))
    values = {key: {one[key] for one in own.values() if key in one} for key in keys}
    alone = len(names) == 1
    common = [key for key in keys if len(values[key]) == 1 and (alone or key != "kind")]
    differing = [key for key in keys if key not in common]
    rows = [(name, *(own[name].get(key, NONE) for key in differing)) for name in names]
    return Settings(
        tuple((LABELS.get(key, key), next(iter(values[key]))) for key in common),
        tuple(LABELS.get(key, key) for key in differing),
        tuple(rows),
    )


def in_words(key: str, value: Any) -> str:
    """A setting's value; knots as time:weight."""
    if key in ("knots", "stencil") and isinstance(value, list):
        return ", ".join(" : ".join(f"{number:g}" for number in knot) for knot in value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        return " – ".join(in_words("", one) for one in value)
    return (
        f"{value:,}" if isinstance(value, int) else f"{value:g}" if isinstance(value, float) else str(value)
    )


def failures(failed: Sequence[Result]) -> tuple[Failure, ...]:
    """By what was said, the most frequent first."""
    by_sentence: dict[str, list[str]] = {}
    for one in failed:
        by_sentence.setdefault(one.error, []).append(f"{one.part}, {one.contender}, seed {one.seed}")
    ranked = sorted(by_sentence.items(), key=lambda pair: -len(pair[1]))
    return tuple(Failure(said, tuple(fits)) for said, fits in ranked)


def flags(found: Sequence[Result], names: Sequence[str]) -> tuple[Flag, ...]:
    """Those of truths with their parts, all others with how many fits of each contender have them."""
    made = Counter(one.contender for one in found if one.fit.get("status") == DONE)
    every = sorted(
        {flag for one in found for flag in one.flags}, key=lambda flag: (not flag.startswith(TRUTH), flag)
    )
    rows = []
    for flag in every:
        having = [one for one in found if flag in one.flags]
        if flag.startswith(TRUTH):
            where = tuple(dict.fromkeys(one.part for one in having))
        else:
            counts = Counter(one.contender for one in having)
            where = tuple(f"{name} {counts[name]} of {made[name]}" for name in names if counts[name])
        rows.append(Flag(flag, MEANINGS.get(flag.removeprefix(TRUTH).removeprefix("mesh-"), ""), where))
    return tuple(rows)
