"""What a 3MF would become in memory, counted before it is read: see `unfolding`.

Its models are XML, read here as a stream. An object holds a mesh, or components: other objects, which may
hold components themselves; the build places objects. Document type declarations, with which an entity can
expand to any size or to another file, have no place in 3MF (core specification, §2.3.1).
"""

from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat
from zipfile import ZipFile

from weingarten.io.archive import checked_members
from weingarten.io.unfolding import check_unfolded, unfolded_size

_ROW = 24
"""Bytes of three coordinates, or of three indices, in memory."""


@dataclass
class _Contents:
    """What the models hold, by the objects' identifiers; `here` is the object that is being read.

    parts: the objects of which one consists. files: the other models that its components name.
    """

    sizes: dict[str, int] = field(default_factory=dict)
    parts: dict[str, list[str]] = field(default_factory=dict)
    built: list[str] = field(default_factory=list)
    files: list[str] = field(default_factory=list)
    here: str = ""

    def begin(self, tag: str, attributes: dict[str, str]) -> None:
        """An element's start."""
        name = tag.rsplit(" ", 1)[-1]
        if name == "object":
            self.here = attributes["id"]
        elif name in ("vertex", "triangle"):
            self.sizes[self.here] = self.sizes.get(self.here, 0) + _ROW
        elif name == "component":
            self.parts.setdefault(self.here, []).append(attributes["objectid"])
            self.files += [value for key, value in attributes.items() if key.endswith("path")]
        elif name == "item":
            self.built.append(attributes["objectid"])


def check_threemf(path: Path) -> None:
    """Raise ValueError for a 3MF that declares entities, holds itself, or unfolds to far more than it is.

    Objects of equal identifiers in several models count as one, which only adds to their size. A component of
    another model has that model read once more.
    """
    contents = _Contents()
    with ZipFile(path) as archive:
        members = {member.filename: member for member in checked_members(archive, path)}
        models = {name: member for name, member in members.items() if ".model" in name.lower()}
        for member in models.values():
            with archive.open(member) as stream:
                _parser(contents).ParseFile(stream)
    named = [name.strip("/") for name in contents.files]
    if any(name in members and name not in models for name in named):
        raise ValueError("its components name a part that is no model")
    again = sum(models[name].file_size for name in named if name in models)
    unfolded = again + unfolded_size(contents.sizes, contents.parts, contents.built)
    check_unfolded(unfolded, path.stat().st_size, "would unfold")


def _parser(contents: _Contents) -> expat.XMLParserType:
    """A parser that tells `contents` what there is."""
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = contents.begin
    parser.StartDoctypeDeclHandler = _refuse
    return parser


def _refuse(*_: object) -> None:
    """A document type declaration."""
    raise ValueError("its XML declares a document type")
