"""What a page shows that can be run: its code blocks in order, and what its comments say of them.

<!-- setup: … -->       Python that the tests run at this place and that readers do not see on the page
<!-- not run: … -->     before a block: why it is only checked for its syntax and options
"""

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
PIECE = re.compile(
    r"^<!-- (?P<remark>setup|not run):(?P<said>.*?)-->$|^```(?P<language>\w*)\n(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
MENTIONED = re.compile(r"`(weingarten [a-z]+ [^`]*)`|^    (weingarten .*)$", re.MULTILINE)


@dataclass(frozen=True)
class Piece:
    """kind: setup, or a block's language. line: its first, from 1. reason: why it is not run, or empty."""

    kind: str
    text: str
    line: int
    reason: str = ""


def pages() -> list[Path]:
    """README.md, CONTRIBUTING.md and all pages of docs/."""
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


def name(page: Path) -> str:
    """The page's path in the repository."""
    return page.relative_to(ROOT).as_posix()


def pieces(page: Path) -> list[Piece]:
    """In order. Raises ValueError for a reason that no block follows."""
    text = page.read_text(encoding="utf-8")
    found, reason = [], ""
    for match in PIECE.finditer(text):
        group = "said" if match["remark"] else "text"
        line = text.count("\n", 0, match.start(group)) + 1
        if match["remark"] == "not run":
            reason = " ".join(match["said"].split())
            if not re.match(r"\s*```", text[match.end() :]):
                raise ValueError(f"{name(page)}:{line} says why something is not run, and no block follows")
        else:
            found.append(Piece(match["remark"] or match["language"], match[group], line, reason))
            reason = ""
    return found


def mentioned(page: Path) -> list[str]:
    """Whole commands outside of blocks: `weingarten` and a verb with words after it."""
    found = MENTIONED.findall(PIECE.sub("", page.read_text(encoding="utf-8")))
    commands = [inline or indented for inline, indented in found]
    return [command for command in commands if not re.fullmatch("weingarten reproduce [a-z]+", command)]
