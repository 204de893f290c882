"""What a page says of a fit first: good, to be looked at, or bad; in a sentence, and each reason in one."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from weingarten.report.facts import counted
from weingarten.report.run.colours import digits
from weingarten.report.run.source import Run

GOOD, LOOK, BAD = "good", "look", "bad"
RANK = (GOOD, LOOK, BAD)
WORDS = {GOOD: "Nothing speaks against it", LOOK: "To be looked at"}
DOUBT, NOTE = "Doubt", "Note"


@dataclass(frozen=True)
class Remark:
    """kind: a word. sentence: what a person should know. grade: how much it matters."""

    kind: str
    sentence: str
    grade: str


@dataclass(frozen=True)
class Verdict:
    """grade: of GOOD, LOOK, BAD. word, sentence: the headline. warnings: what else, the gravest first."""

    grade: str
    word: str
    sentence: str
    warnings: tuple[Remark, ...]


def verdict(run: Run) -> Verdict:
    """What there is to be said of a run."""
    if run.summary is None:
        return Verdict(BAD, "No mesh", without_mesh(run), ())
    found = [*interrupted(run), *against(run.summary, float(run.settings.get("trim", 0.0)))]
    warnings = sorted(found, key=lambda one: -RANK.index(one.grade))
    grade = warnings[0].grade if warnings else GOOD
    word = WORDS.get(grade) or warnings[0].kind
    return Verdict(grade, word, headline(run.summary, warnings), tuple(warnings))


def without_mesh(run: Run) -> str:
    """That there is no mesh, and what to do."""
    steps = f"after step {run.taken:,} of {run.planned:,}"
    return (
        f"This run has no mesh: it ended {steps}, before its surface was extracted; the same command with "
        "--resume goes on from there."
    )


def interrupted(run: Run) -> list[Remark]:
    """That a fit was not carried to its end, if so."""
    if (run.summary or {}).get("finished", True):
        return []
    said = (
        f"This fit was interrupted after step {run.taken:,} of {run.planned:,}: mesh and figures are of the "
        "steps taken; the same command with --resume goes on from there."
    )
    return [Remark("Interrupted", said, BAD)]


def against(summary: dict[str, Any], trim: float) -> list[Remark]:
    """What speaks against a mesh, and what was noted while it was made."""
    found = []
    if not summary.get("watertight", True):
        said = "The mesh is open: it encloses nothing, so it has no volume, and deviations have no sign."
        if trim > 0.0:
            said += f" That is what --trim-distance {trim:g} asked for."
        found.append(Remark("Open", said, LOOK if trim > 0.0 else BAD))
    crossing = int(summary.get("self_intersecting") or 0)
    if crossing:
        said = (
            f"{counted(crossing, 'face')} of {int(summary.get('faces', 0)):,} pass through others: programs "
            "that want a clean solid may ask for a repair there."
        )
        found.append(Remark(DOUBT, said, LOOK))
    if int(summary.get("components", 1)) > 1:
        said = (
            f"The mesh is in {summary['components']} separate pieces; a part that is of one piece has "
            "broken up, or something beside it was scanned."
        )
        found.append(Remark("Pieces", said, LOOK))
    found += [Remark(DOUBT, str(one), LOOK) for one in summary.get("doubts") or ()]
    return found + [Remark(NOTE, str(one), GOOD) for one in summary.get("notes") or ()]


def headline(summary: dict[str, Any], warnings: Sequence[Remark]) -> str:
    """The mesh in a sentence, with how many doubts there are."""
    doubts = sum(one.kind == DOUBT for one in warnings)
    said = ["Watertight" if summary.get("watertight") else "Not watertight"]
    said.append("one piece" if summary.get("components") == 1 else f"{summary.get('components')} pieces")
    if (genus := summary.get("genus")) is not None:
        said.append(f"{counted(int(genus), 'through-hole') if genus else 'no through-hole'} (genus {genus})")
    near = ""
    if "distance_p95" in summary:
        near = (
            f"; 95 % of the points lie within {digits(summary['distance_p95'], 3)} of the mesh, all within "
            f"{digits(summary['distance_max'], 3)}, in the cloud’s unit"
        )
    against = f"; {counted(doubts, 'doubt')}" if doubts else ""
    return f"{', '.join(said)}{near}{against}."
