"""What the view in 3D is told: every part's scenes, colours and light, as plain values for JSON."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import UInt8

from weingarten.report.gallery import PartView
from weingarten.report.heat import colour_map
from weingarten.report.looks import looks
from weingarten.report.scene import Scene
from weingarten.report.shading import LIGHTS, Lights

TALL = 0.77
"""Least height that a part is given beside its width: flat ones need it once they are turned."""


def viewing(views: Sequence[PartView]) -> tuple[dict[str, Any], list[tuple[str, str]]]:
    """Settings of the view, and the packed scenes by the id of the element that holds them."""
    scenes: list[tuple[str, str]] = []
    parts = [part_settings(number, view, scenes) for number, view in enumerate(views)]
    modes = (("shaded", "Shaded"), ("error", "Error"), ("missed", "Missed"))
    return settings_of(parts, colour_map(), modes), scenes


def settings_of(
    parts: list[dict[str, Any]],
    colours: UInt8[np.ndarray, "256 3"],
    modes: Sequence[tuple[str, str]],
    mode: str = "shaded",
    unknown: bool = False,
    lights: Lights = LIGHTS,
) -> dict[str, Any]:
    """What every view in 3D is told. modes: keys of captions, and what their buttons say. mode: the first.

    unknown: whether the first colour is of places of which nothing is known.
    """
    return {
        "parts": parts,
        "modes": [list(one) for one in modes],
        "mode": mode,
        "unknown": unknown,
        "colours": colours.reshape(-1).tolist(),
        **looks(lights),
    }


def part_settings(number: int, view: PartView, scenes: list[tuple[str, str]]) -> dict[str, Any]:
    """Of one part; its scenes are added to the list."""
    truth = None
    if view.truth is not None:
        scene = scene_settings(f"scene-{number}-truth", view.truth.scene, scenes)
        truth = {"scene": scene, "captions": {"shaded": f"{view.name}: the truth"}}
    return {
        "name": view.name,
        **placed(view.target, view.extent, view.size),
        "ticks": [] if view.scale is None else [list(tick) for tick in view.scale.ticks()],
        "truth": truth,
        "meshes": [mesh_settings(number, k, view, scenes) for k in range(len(view.cards))],
    }


def placed(target: tuple[float, float, float], extent: float, size: tuple[int, int]) -> dict[str, Any]:
    """What the view looks at and how wide and tall it is; see PartView."""
    return {
        "target": [round(value, 6) for value in target],
        "extent": round(extent, 6),
        "tall": round(extent * max(size[1] / size[0], TALL), 6),
    }


def mesh_settings(number: int, k: int, view: PartView, scenes: list[tuple[str, str]]) -> dict[str, Any]:
    """Of one contender's mesh. captions: by mode, as far as it can be shown so.

    missed: where the levels of the truth's vertices are, if anywhere.
    """
    key, card = f"scene-{number}-{k}", view.cards[k]
    captions = {"shaded": f"{view.name}: {card.contender}"}
    found: dict[str, Any] = {"name": card.contender, "scene": None, "missed": None, "captions": captions}
    if card.scene is not None:
        found["scene"] = scene_settings(key, card.scene, scenes)
    if card.missed_levels is not None and view.scale is not None:
        name, unit = card.contender, view.scale.unit
        found["missed"] = f"{key}-missed"
        scenes.append((f"{key}-missed", card.missed_levels))
        captions["error"] = f"{view.name}: {name}, distance of the mesh to the truth, {unit}"
        captions["missed"] = f"{view.name}: the truth, distance to the mesh of {name}, {unit}"
    return found


def scene_settings(key: str, scene: Scene, scenes: list[tuple[str, str]]) -> dict[str, Any]:
    """Where a scene is and how it is unpacked."""
    scenes.append((key, scene.data))
    return {"id": key, "vertices": scene.vertices, "faces": scene.faces, "low": scene.low, "step": scene.step}
