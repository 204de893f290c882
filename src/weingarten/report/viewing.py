"""What the view in 3D is told: every part's scenes, colours and light, as plain values for JSON."""

from collections.abc import Sequence
from typing import Any

from weingarten.report.gallery import Card, PartView
from weingarten.report.looks import looks
from weingarten.report.scene import Scene

TALL = 0.77
"""Least height that a part is given beside its width: flat ones need it once they are turned."""


def viewing(views: Sequence[PartView]) -> tuple[dict[str, Any], list[tuple[str, str]]]:
    """Settings of the view, and the packed scenes by the id of the element that holds them."""
    scenes: list[tuple[str, str]] = []
    parts = [part_settings(number, view, scenes) for number, view in enumerate(views)]
    settings = {"parts": parts, **looks()}
    return settings, scenes


def part_settings(number: int, view: PartView, scenes: list[tuple[str, str]]) -> dict[str, Any]:
    """Of one part; its scenes are added to the list."""
    return {
        "name": view.name,
        "target": [round(value, 6) for value in view.target],
        "extent": round(view.extent, 6),
        "tall": round(view.extent * max(view.size[1] / view.size[0], TALL), 6),
        "unit": "" if view.scale is None else view.scale.unit,
        "ticks": [] if view.scale is None else [list(tick) for tick in view.scale.ticks()],
        "truth": None
        if view.truth is None
        else scene_settings(f"scene-{number}-truth", view.truth.scene, scenes),
        "meshes": [mesh_settings(f"scene-{number}-{k}", card, scenes) for k, card in enumerate(view.cards)],
    }


def mesh_settings(key: str, card: Card, scenes: list[tuple[str, str]]) -> dict[str, Any]:
    """Of one contender's mesh. missed: where the levels of the truth's vertices are, if anywhere."""
    found: dict[str, Any] = {"name": card.contender, "scene": None, "missed": None}
    if card.scene is not None:
        found["scene"] = scene_settings(key, card.scene, scenes)
    if card.missed_levels is not None:
        found["missed"] = f"{key}-missed"
        scenes.append((f"{key}-missed", card.missed_levels))
    return found


def scene_settings(key: str, scene: Scene, scenes: list[tuple[str, str]]) -> dict[str, Any]:
    """Where a scene is and how it is unpacked."""
    scenes.append((key, scene.data))
    return {"id": key, "vertices": scene.vertices, "faces": scene.faces, "low": scene.low, "step": scene.step}
