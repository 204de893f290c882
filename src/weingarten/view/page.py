"""The page: one HTML text with style and scripts, which asks a server or carries along all that it shows.

Scripts and style are allowed by their hashes, and nothing else is; only the page of a server may ask it.
"""

import base64
import hashlib
import json
from collections.abc import Iterator
from functools import partial
from html import escape
from itertools import product
from pathlib import Path
from string import Template
from typing import Any

from weingarten.atomic import check_writable, replacing
from weingarten.browser.asset import asset, drawing, palette
from weingarten.view.exhibit import Exhibit
from weingarten.view.item import opened
from weingarten.view.section import AXES, PLACES

SCRIPTS = ("source.js", "cloud.js", "cut.js", "curve.js", "stage.js", "view.js")

CUTS = 21
"""Cross-sections along each axis of a page without a server."""


def live_page(exhibit: Exhibit) -> tuple[str, str]:
    """The page of a server, and its Content-Security-Policy."""
    facts = {**exhibit.facts(), "live": True, "cuts": PLACES + 1}
    return page(exhibit.subject.name, {"facts": facts}, "'self'")


def page(title: str, blocks: dict[str, Any], connect: str) -> tuple[str, str]:
    """The page with these values in it, by their names, and its Content-Security-Policy."""
    own = partial(asset, "weingarten.view")
    style = palette() + own("view.css")
    script = "\n".join([drawing(), *(own(name) for name in SCRIPTS)])
    policy = (
        f"default-src 'none'; script-src {hashed(script)}; style-src {hashed(style)}; "
        f"img-src data:; connect-src {connect}; base-uri 'none'; form-action 'none'"
    )
    data = "\n".join(
        f'<script type="application/json" id="{escape(key)}">{embedded(value)}</script>'
        for key, value in blocks.items()
    )
    template = Template(own("view.html"))
    return template.substitute(
        title=escape(title), policy=policy, style=style, script=script, data=data
    ), policy


def write_page(exhibit: Exhibit, path: Path) -> int:
    """Write a page that needs no server; its size in bytes. Raises OutputError, WeingartenError.

    It holds the surfaces of all steps, every colouring of the final one and CUTS sections along each axis.
    """
    check_writable(path)
    state = exhibit.state()
    items = dict(all_items(exhibit, state))
    facts = {**exhibit.facts(), "live": False, "cuts": CUTS}
    coded = {key: base64.b64encode(content).decode() for key, content in items.items()}
    text, _ = page(exhibit.subject.name, {"facts": facts, "state": state, **coded}, "'none'")
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return len(text.encode())


def all_items(exhibit: Exhibit, state: dict[str, Any]) -> Iterator[tuple[str, bytes]]:
    """The items that a page without a server may come to want, by the addresses that a server has them at."""
    if exhibit.subject.cloud is not None:
        yield "points", exhibit.points()
    steps = [*state["steps"], *([None] if state["final"] else [])]
    for step in steps:
        more = "" if step is None else f"step={step}"
        yield joined("scene", more), exhibit.scene(step)
        for key, _ in opened(exhibit.scene(step))[0]["colourings"]:
            yield joined("colours", f"by={key}", more), exhibit.colours(key, step)
    if exhibit.subject.box is not None:
        for step, axis, k in product(steps[-1:], AXES, range(CUTS)):
            more, place = "" if step is None else f"step={step}", round(PLACES * k / (CUTS - 1))
            yield joined("section", f"axis={axis}", f"at={place}", more), exhibit.section(axis, place, step)


def joined(name: str, *pairs: str) -> str:
    """An address."""
    query = "&".join(pair for pair in pairs if pair)
    return f"{name}?{query}" if query else name


def embedded(value: Any) -> str:
    """JSON that cannot end the element that it stands in."""
    return json.dumps(value, allow_nan=False).replace("<", "\\u003c")


def hashed(text: str) -> str:
    """A source of a Content-Security-Policy: the SHA-256 of an element's content."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
