"""What the page may ask for of a subject: its facts, how it stands, surfaces, points, colours and sections.

Everything is an item (`weingarten.view.item`) or plain values for JSON. What was made is kept for a while.
"""

import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from weingarten.errors import InputError
from weingarten.fit.curve import Columns
from weingarten.report.looks import looks
from weingarten.report.scene import face_planes, place_planes
from weingarten.view.colouring import COLOURINGS, Colouring, Material, Scale, maps
from weingarten.view.display import POINTS, Displayed, displayed, few
from weingarten.view.item import item
from weingarten.view.primitives import paint_map
from weingarten.view.section import AXES, section
from weingarten.view.subject import Look, Subject, Surface

KEPT = 400
"""Things made that are kept, of which a surface is the largest: about a megabyte."""

COARSE = 25_000
"""Triangles shown at most of surfaces on the way, which are many, ragged and looked at in passing."""

CURVE = 240
"""Places of the loss curve that is shown."""

PRIMITIVES = "primitives"

Made = TypeVar("Made")


@dataclass(frozen=True)
class Piece:
    """A surface made ready: as it is, and as it is drawn."""

    surface: Surface
    drawn: Displayed
    material: Material


class Exhibit:
    """A subject, and what was made of it. Every method may be called from any thread.

    triangles: shown at most. Methods raise a WeingartenError for what is not there.
    """

    def __init__(self, subject: Subject, triangles: int) -> None:
        self.subject = subject
        self.triangles = triangles
        self.made: OrderedDict[tuple, Any] = OrderedDict()
        self.making, self.looking = threading.RLock(), threading.Lock()

    def look(self) -> Look:
        """See Subject."""
        with self.looking:
            return self.subject.look()

    def kept(self, look: Look, key: tuple, make: Callable[[], Made]) -> Made:
        """What was made before, else what is made now."""
        key = (look.version, look.final, *key)
        with self.making:
            if key not in self.made:
                self.made[key] = make()
                if len(self.made) > KEPT:
                    self.made.popitem(last=False)
            self.made.move_to_end(key)
            return self.made[key]

    def facts(self) -> dict[str, Any]:
        """What does not change while the page is open."""
        subject, cloud, box = self.subject, self.subject.cloud, self.subject.box
        frame = subject.frame
        return {
            "name": subject.name,
            "frame": {"centre": frame.centre, "scale": frame.scale},
            "unit": "the file's unit" if cloud is None else "the cloud's unit",
            "points": 0 if cloud is None else cloud.given,
            "box": None if box is None else {"lower": box.lower.tolist(), "upper": box.upper.tolist()},
            "spacing": None if box is None else box.spacing,
            "maps": {**maps(), PRIMITIVES: paint_map()},
            **looks(),
        }

    def state(self) -> dict[str, Any]:
        """How it stands."""
        look = self.look()
        status = look.status
        return {
            "version": look.version,
            "final": look.final,
            "steps": list(look.steps),
            "status": None if status is None else vars(status),
            "curve": curve(look.curve),
            "facts": list(look.facts),
        }

    def piece(self, look: Look, step: int | None) -> Piece:
        """The final surface, or that of a step."""

        def make() -> Piece:
            check_there(look, step)
            surface, cloud = self.subject.surface(step), self.subject.cloud
            drawn = displayed(surface.mesh, self.triangles if step is None else min(self.triangles, COARSE))
            points, noise = (None, 0.0) if cloud is None else (cloud.points, cloud.noise)
            return Piece(surface, drawn, Material(drawn.mesh, surface.mesh, points, noise, surface.field))

        return self.kept(look, ("piece", step), make)

    def scene(self, step: int | None) -> bytes:
        """The item of a surface: counts, places, faces, and what it can be coloured by."""
        look = self.look()

        def make() -> bytes:
            piece = self.piece(look, step)
            mesh = piece.drawn.mesh
            low, size, content = place_planes(self.subject.frame.to_unit(mesh.vertices))
            said = {
                "vertices": len(mesh.vertices),
                "faces": len(mesh.faces),
                "low": low,
                "step": size,
                "whole": piece.drawn.whole,
                "note": piece.drawn.note if step is None else "",
                "colourings": [[key, title] for key, title in self.offered(piece)],
            }
            return item(said, content + face_planes(mesh))

        return self.kept(look, ("scene", step), make)

    def offered(self, piece: Piece) -> list[tuple[str, str]]:
        """Keys and titles of what a surface can be coloured by."""
        own = piece.material
        there = {name for name in ("points", "field") if getattr(own, name) is not None}
        found = [(one.key, one.title) for one in COLOURINGS if one.needs in there]
        return found + ([(PRIMITIVES, "Primitives")] if piece.surface.primitives is not None else [])

    def points(self) -> bytes:
        """The item of the points: how many, how many there are, places."""
        look, cloud = self.look(), self.subject.cloud
        if cloud is None:
            raise InputError(f"{self.subject.name} has no points.")

        def make() -> bytes:
            shown = few(cloud.points)
            low, size, content = place_planes(self.subject.frame.to_unit(shown))
            said = {"vertices": len(shown), "given": cloud.given, "low": low, "step": size}
            return item(said, content)

        return self.kept(look, ("points", POINTS), make)

    def colours(self, by: str, step: int | None) -> bytes:
        """The item of a colouring: its words, and a byte for every vertex, of primitives for every face."""
        look = self.look()
        if by == PRIMITIVES:
            return self.kept(look, ("colours", by, step), lambda: self.painted(look, step))
        one = next((one for one in COLOURINGS if one.key == by), None)
        if one is None:
            raise InputError(f"There is no colouring {by!r}.")

        def make() -> bytes:
            piece, scale = self.piece(look, step), self.scale(look, one, step)
            said = {"per": "vertex", "map": scale.colours, "unit": one.unit, "ticks": scale.ticks()}
            return item(said, scale.places(self.values(piece, one)).tobytes())

        return self.kept(look, ("colours", by, step), make)

    def values(self, piece: Piece, one: Colouring) -> np.ndarray:
        """At the vertices of the surface as drawn."""
        if getattr(piece.material, one.needs) is None:
            raise InputError(f"{one.title} needs the {one.needs}, which {self.subject.name} has not.")
        return one.values(piece.material)

    def scale(self, look: Look, one: Colouring, step: int | None) -> Scale:
        """One scale for all steps, that of the final surface, as soon as there is one."""
        last = None if look.final else step

        def make() -> Scale:
            piece = self.piece(look, last)
            return one.scale(self.values(piece, one), piece.material.areas)

        return self.kept(look, ("scale", one.key, last), make)

    def painted(self, look: Look, step: int | None) -> bytes:
        """The item of the primitives."""
        piece = self.piece(look, step)
        known = piece.surface.primitives
        if known is None:
            raise InputError(f"Of {self.subject.name} no primitives are known.")
        said = {"per": "face", "map": PRIMITIVES, "unit": "", "ticks": [], "legend": known.legend()}
        return item(said, known.paints(piece.surface.mesh, piece.drawn.mesh).tobytes())

    def section(self, axis: str, place: int, step: int | None) -> bytes:
        """The item of a cross-section of the field of a surface. place: see `weingarten.view.section`."""
        look, box = self.look(), self.subject.box
        if box is None:
            raise InputError(f"{self.subject.name} has no field.")

        def make() -> bytes:
            field = self.piece(look, step).surface.field
            assert field is not None
            return section(field, box, AXES.index(axis), place)

        return self.kept(look, ("section", axis, place, step), make)


def check_there(look: Look, step: int | None) -> None:
    """Raise InputError unless there is such a surface now."""
    if (step is None and not look.final) or (step is not None and step not in look.steps):
        raise InputError("There is no such surface now.")


def curve(columns: Columns) -> dict[str, list[float | None]]:
    """Steps and losses for the plot: geometric means where there are more than can be seen."""
    if "loss" not in columns or "step" not in columns:
        return {"step": [], "loss": []}
    good = np.isfinite(columns["loss"]) & (columns["loss"] > 0)
    step, loss = columns["step"][good], np.log(columns["loss"][good])
    pieces = np.array_split(np.arange(len(step)), min(len(step), CURVE)) if len(step) else []
    return {
        "step": [float(step[own].mean()) for own in pieces],
        "loss": [float(f"{np.exp(loss[own].mean()):.4g}") for own in pieces],
    }
