"""The site's pages beside those in docs/, and what is done about pages that are not there; a hook of mkdocs.

What lies outside of docs/ and is worth reading (OUTSIDE) becomes a page or a file of the site. A link that
leads out of docs/ goes to that page, or, where the site has none, is left as its words alone. Entries of the
navigation without a page are left out; a link to nothing stays, and stops the build.
"""

import os.path
import re
from pathlib import Path, PurePosixPath

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files, InclusionLevel
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
OUTSIDE = ("CHANGELOG.md", "CONTRIBUTING.md", "results/*.md", "results/*.csv")
LINK = re.compile(r"(?<!!)\[(?P<words>[^\]]+)\]\((?P<path>[^)#:\s]+)(?P<anchor>#[^)\s]*)?\)")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """The configuration with a navigation of pages that are there."""
    config.nav = present(config.nav or [])
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """The files of the site, those from outside with them."""
    for pattern in OUTSIDE:
        for path in sorted(ROOT.glob(pattern)):
            uri, inclusion = path.relative_to(ROOT).as_posix(), InclusionLevel.NOT_IN_NAV
            files.append(File.generated(config, uri, abs_src_path=str(path), inclusion=inclusion))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """The page with its links into the repository led to the site's own pages."""
    place, uri = Path(page.file.abs_src_path or "").parent, PurePosixPath(page.file.src_uri)

    def led(found: re.Match[str]) -> str:
        target = (place / found["path"]).resolve()
        there = site_uri(target)
        if there is None or files.get_file_from_path(there) is None:
            return found["words"] if target.exists() else found[0]
        return f"[{found['words']}]({os.path.relpath(there, uri.parent)}{found['anchor'] or ''})"

    return LINK.sub(led, markdown)


def site_uri(path: Path) -> str | None:
    """Where a file of the repository would be on the site."""
    if path.is_relative_to(DOCS):
        return path.relative_to(DOCS).as_posix()
    return path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else None


def present(entries: list) -> list:
    """The entries of a navigation whose pages are there; sections without any are left out."""
    kept = []
    for entry in entries:
        ((title, value),) = entry.items() if isinstance(entry, dict) else ((None, entry),)
        if isinstance(value, list):
            value = present(value)
        elif not any((folder / value).exists() for folder in (DOCS, ROOT)):
            continue
        if value:
            kept.append(value if title is None else {title: value})
    return kept
