"""Templates of pages, which the package brings along, and where a page may be written."""

from functools import partial
from pathlib import Path
from typing import Any

from weingarten.atomic import check_writable, replacing
from weingarten.browser.asset import asset, drawing, palette
from weingarten.errors import OutputError
from weingarten.report import extra

FORMATS = (".html", ".htm")


def rendered(name: str, **values: Any) -> str:
    """The template of that name with these values; all text is escaped but the plots, which are SVG."""
    jinja2, markup = extra.required("jinja2"), extra.required("markupsafe").Markup
    own = partial(asset, "weingarten.report")
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(own),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["svg"] = markup
    environment.globals["asset"] = lambda name: markup(own(name))
    environment.globals["palette"] = markup(palette())
    environment.globals["drawing"] = markup(drawing())
    return environment.get_template(name).render(**values)


def check_page_path(path: Path) -> None:
    """Raise OutputError unless a page can be written to `path`."""
    check_page_name(path)
    check_writable(path)


def check_page_name(path: Path) -> None:
    """Raise OutputError unless the name is that of a page."""
    if path.suffix.lower() not in FORMATS:
        raise OutputError(f"{path} is to be a page; end its name in .html.")


def write(path: Path, page: str) -> int:
    """Write a page; how many bytes it has. Raises OutputError."""
    content = page.encode("utf-8")
    with replacing(path) as temporary:
        temporary.write_bytes(content)
    return len(content)
