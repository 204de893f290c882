"""Meshes written as binary glTF. Its vertices are single precision, so they are stored about their centre.

The node's transform, in double-precision JSON, carries the centre and, for parts smaller than a
thousandth or larger than a million units, a power of two as the scale. Axes are written as they are.
"""

import json
import math
import struct
from pathlib import Path

import numpy as np

from weingarten.mesh import Mesh

_FLOAT, _UINT, _VERTICES, _INDICES = 5126, 5125, 34962, 34963


def write_glb(path: Path, mesh: Mesh) -> tuple[str, ...]:
    """Write one node with one mesh; positions return to within 1e-7 of the part's size. No notes."""
    low, high = mesh.bounds
    centre, half = low + (high - low) / 2, float((high - low).max() / 2)
    scale = 1.0 if 1e-3 <= half <= 1e6 or half == 0.0 else 2.0 ** round(math.log2(half))
    positions = ((mesh.vertices - centre) / scale).astype("<f4")
    faces = mesh.faces.astype("<u4")
    text = json.dumps(_document(positions, faces, centre.tolist(), scale)).encode("ascii")
    text = text.ljust(-(-len(text) // 4) * 4, b" ")
    body = positions.tobytes() + faces.tobytes()
    with path.open("wb") as stream:
        stream.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(body)))
        stream.write(struct.pack("<I4s", len(text), b"JSON") + text)
        stream.write(struct.pack("<I4s", len(body), b"BIN\0") + body)
    return ()


def _document(positions: np.ndarray, faces: np.ndarray, centre: list[float], scale: float) -> dict:
    """The JSON part: scene, node with its transform, mesh, and where its numbers are."""
    return {
        "asset": {"version": "2.0", "generator": "weingarten"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": centre, "scale": [scale] * 3}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4}]}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": _FLOAT,
                "count": len(positions),
                "type": "VEC3",
                "min": positions.min(axis=0).tolist(),
                "max": positions.max(axis=0).tolist(),
            },
            {"bufferView": 1, "componentType": _UINT, "count": faces.size, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": positions.nbytes, "target": _VERTICES},
            {"buffer": 0, "byteOffset": positions.nbytes, "byteLength": faces.nbytes, "target": _INDICES},
        ],
        "buffers": [{"byteLength": positions.nbytes + faces.nbytes}],
    }
