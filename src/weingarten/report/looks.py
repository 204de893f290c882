"""How every view in 3D looks: camera, creases and light, as in the pictures."""

from typing import Any

import numpy as np

from weingarten.report import panel, shading
from weingarten.report.camera import AZIMUTH, ELEVATION


def looks(lights: shading.Lights = shading.LIGHTS) -> dict[str, Any]:
    """Where the camera begins, creases and light, as plain values for JSON."""
    shining = []
    for direction, power in lights:
        unit = np.asarray(direction) / np.linalg.norm(direction)
        shining.append([*(round(float(value), 5) for value in unit), power])
    return {
        "azimuth": round(float(np.degrees(AZIMUTH)), 6),
        "elevation": round(float(np.degrees(ELEVATION)), 6),
        "crease": round(float(shading.CREASE), 6),
        "light": {
            "lights": shining,
            "ambient": shading.AMBIENT,
            "sheen": shading.SHEEN,
            "front": shading.FRONT,
            "back": shading.BACK,
            "shade": panel.SHADE,
            "tint": panel.TINT,
        },
    }
