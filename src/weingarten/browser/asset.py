"""Files that pages are made of: a page's own, and those that all pages share."""

from importlib.resources import files


def asset(package: str, name: str) -> str:
    """A file of a package's folder page/."""
    return (files(package) / "page" / name).read_text(encoding="utf-8")


def palette() -> str:
    """Colours by day and by night, and typefaces: variables for the style of a page."""
    return asset("weingarten.browser", "palette.css")
