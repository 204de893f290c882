"""What an address of the page stands for: a fixed table. Nothing in an address is ever a name of a file."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from urllib.parse import parse_qsl, urlsplit

from weingarten.errors import WeingartenError
from weingarten.view.colouring import COLOURINGS
from weingarten.view.exhibit import PRIMITIVES, Exhibit
from weingarten.view.page import live_page
from weingarten.view.section import AXES, PLACES

HTML, JSON, BYTES = "text/html; charset=utf-8", "application/json", "application/octet-stream"
MOST_STEPS = 10_000_000

Values = Mapping[str, str]


@dataclass(frozen=True)
class Answer:
    """kind: of the content. policy: the Content-Security-Policy, of pages."""

    kind: str
    content: bytes
    policy: str = "default-src 'none'"


class NotThereError(Exception):
    """The address stands for nothing; the sentence is for whoever asked."""


def answer(exhibit: Exhibit, address: str) -> Answer:
    """What is at an address: a path and a query. Raises NotThereError."""
    parts = urlsplit(address)
    route = ROUTES.get(parts.path)
    if route is None or len(parts.query) > 200:
        raise NotThereError("There is nothing here.")
    try:
        pairs = parse_qsl(
            parts.query, keep_blank_values=True, strict_parsing=bool(parts.query), max_num_fields=4
        )
    except ValueError as error:
        raise NotThereError("The question cannot be read.") from error
    values = dict(pairs)
    names, make = route
    if len(values) != len(pairs) or not values.keys() <= set(names):
        raise NotThereError("The question has a part that means nothing here.")
    try:
        return make(exhibit, values)
    except WeingartenError as error:
        raise NotThereError(str(error)) from error


def page(exhibit: Exhibit, values: Values) -> Answer:
    """The page itself."""
    text, policy = live_page(exhibit)
    return Answer(HTML, text.encode(), policy)


def state(exhibit: Exhibit, values: Values) -> Answer:
    """How it stands."""
    return Answer(JSON, json.dumps(exhibit.state(), allow_nan=False).encode())


def scene(exhibit: Exhibit, values: Values) -> Answer:
    """A surface."""
    return Answer(BYTES, exhibit.scene(step_of(values)))


def points(exhibit: Exhibit, values: Values) -> Answer:
    """The points."""
    return Answer(BYTES, exhibit.points())


def colours(exhibit: Exhibit, values: Values) -> Answer:
    """The colours of a surface."""
    by = one_of(values, "by", [PRIMITIVES, *(colouring.key for colouring in COLOURINGS)])
    return Answer(BYTES, exhibit.colours(by, step_of(values)))


def section(exhibit: Exhibit, values: Values) -> Answer:
    """A cross-section."""
    axis, place = one_of(values, "axis", list(AXES)), whole(values, "at", PLACES)
    return Answer(BYTES, exhibit.section(axis, place, step_of(values)))


def one_of(values: Values, name: str, known: list[str]) -> str:
    """A value that is one of the known ones. Raises NotThereError."""
    if values.get(name) not in known:
        raise NotThereError(f"{name} is to be one of {', '.join(known)}.")
    return values[name]


def whole(values: Values, name: str, most: int) -> int:
    """A value that is a whole number from 0 to `most`. Raises NotThereError."""
    text = values.get(name, "")
    if not (text.isascii() and text.isdecimal() and len(text) < 9 and int(text) <= most):
        raise NotThereError(f"{name} is to be a whole number from 0 to {most}.")
    return int(text)


def step_of(values: Values) -> int | None:
    """The step that is asked for; None for the final surface. Raises NotThereError."""
    return whole(values, "step", MOST_STEPS) if "step" in values else None


Route = tuple[tuple[str, ...], Callable[[Exhibit, Values], Answer]]

ROUTES: Mapping[str, Route] = {
    "/": ((), page),
    "/state": ((), state),
    "/scene": (("step",), scene),
    "/points": ((), points),
    "/colours": (("by", "step"), colours),
    "/section": (("axis", "at", "step"), section),
}
