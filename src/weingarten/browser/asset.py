"""Files that pages are made of: a page's own, and those that all pages share."""

from importlib.resources import files

OWN = "weingarten.browser"
DRAWING = ("scene.js", "webgl.js", "surface.js", "orbit.js", "ticks.js")
"""Scripts of a view in 3D."""


def asset(package: str, name: str) -> str:
    """A file of a package's folder page/."""
    return (files(package) / "page" / name).read_text(encoding="utf-8")


def palette() -> str:
    """Colours by day and by night, and typefaces: variables for the style of a page."""
    return asset(OWN, "palette.css")


def drawing() -> str:
    """Functions that unpack meshes, draw them and turn them, for the script of a page."""
    return "\n".join(asset(OWN, name) for name in DRAWING)
