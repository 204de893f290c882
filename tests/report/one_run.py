"""A run folder made of exact primitives: nothing is fitted, and every deviation is known."""

import csv
import json
from pathlib import Path

import numpy as np
import tomli_w
import trimesh

from weingarten.io.mesh import write_mesh
from weingarten.mesh import Mesh
from weingarten.settings import resolve
from weingarten.summary import summarise

EVIL = "<script>document.title = 'broken in'</script> & \"more\""
GROUPS = ((600, 0.1), (300, -0.15), (95, 0.0), (5, 0.5))
"""How many points lie how far outside of the mesh."""
MIDDLE, SIDE = np.array([100.0, -50.0, 7.0]), 10.0
STEPS = 60
TERMS = {"eikonal": 50.0, "off_diagonal_weingarten": 10.0}


def box() -> Mesh:
    """A cube in world units, with faces enough for colours to differ."""
    shape = trimesh.creation.box((SIDE, SIDE, SIDE)).subdivide().subdivide()
    return Mesh(np.array(shape.vertices) + MIDDLE, np.array(shape.faces, dtype=np.int64))


def cloud() -> np.ndarray:
    """Points over the middle of the cube's faces, GROUPS along the faces' normals."""
    off = np.concatenate([np.full(count, d) for count, d in GROUPS])
    generator = np.random.default_rng(0)
    face = generator.permutation(len(off)) % 6
    inner = generator.uniform(-0.45 * SIDE, 0.45 * SIDE, (len(off), 3))
    axis, sign = face % 3, np.where(face < 3, 1.0, -1.0)
    inner[np.arange(len(off)), axis] = sign * (SIDE / 2 + off)
    return inner + MIDDLE


def make(folder: Path, mesh: Mesh | None = None, **changes: object) -> Path:
    """A finished run. mesh: instead of the cube. changes: of the summary."""
    folder.mkdir(parents=True)
    own, points = mesh or box(), cloud()
    summary = summarise(
        points, own, 0.0, STEPS, STEPS, True, 1.5, {"preparing": 1.0, "fitting": 4.0}, (EVIL,)
    )
    (folder / "summary.json").write_text(json.dumps(summary.as_dict() | changes))
    write_mesh(folder / "mesh.ply", own)
    np.save(folder / "cloud.npy", points)
    settings = resolve(steps=STEPS, seed=3)
    (folder / "config.toml").write_bytes(tomli_w.dumps(settings.as_dict()).encode())
    made = {
        "cloud": f"/scans/{EVIL}.ply".replace("</", "<"),
        "mesh": "part.stl",
        "command": f"weingarten fit '{EVIL}' -o part.stl",
        "version": "0.1.0",
        "commit": "0123abc",
        "machine": "A machine, 2 cores",
        "date": "2026-01-01",
    }
    (folder / "made.json").write_text(json.dumps(made))
    write_curve(folder / "loss.csv")
    return folder


def without_mesh(folder: Path) -> Path:
    """The same, ended before its surface was extracted."""
    make(folder)
    for name in ("mesh.ply", "summary.json"):
        (folder / name).unlink()
    lines = (folder / "loss.csv").read_text().splitlines()[:21]
    (folder / "loss.csv").write_text("\n".join(lines) + "\n")
    return folder


def write_curve(path: Path) -> None:
    """The loss falls by one power of ten; the weight of the last term to zero, whence it is not known."""
    with path.open("w", newline="") as stream:
        writer = csv.writer(stream)
        head = ["step", "progress", "rate", "loss", "seconds"]
        writer.writerow([*head, *TERMS, *(f"weight_{name}" for name in TERMS)])
        for step in range(STEPS):
            t = step / STEPS
            weight = max(0.0, 10 * (1 - 2 * t))
            writer.writerow([step, t, 5e-4, 100 * 10**-t, 0.01, 0.5, 2.0 if weight else "nan", 50.0, weight])
