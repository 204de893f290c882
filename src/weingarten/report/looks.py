"""How every view in 3D looks: camera, colours, creases and light, as in the pictures."""

from typing import Any

import numpy as np

from weingarten.report import panel, shading
from weingarten.report.camera import AZIMUTH, ELEVATION
from weingarten.report.heat import colour_map


def looks() -> dict[str, Any]:
    """Where the camera begins, colours, creases and light, as plain values for JSON."""
    lights = []
    for direction, power in shading.LIGHTS:
        unit = np.asarray(direction) / np.linalg.norm(direction)
        lights.append([*(round(float(value), 5) for value in unit), power])
    return {
        "azimuth": round(float(np.degrees(AZIMUTH)), 6),
        "elevation": round(float(np.degrees(ELEVATION)), 6),
        "colours": colour_map().reshape(-1).tolist(),
        "crease": round(float(shading.CREASE), 6),
        "light": {
            "lights": lights,
            "ambient": shading.AMBIENT,
            "sheen": shading.SHEEN,
            "front": shading.FRONT,
            "back": shading.BACK,
            "shade": panel.SHADE,
            "tint": panel.TINT,
        },
    }
