"""A tiny benchmark's folder, made of exact primitives: nothing is fitted."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import trimesh

from weingarten.bench.store import Entry, Store
from weingarten.io.mesh import write_mesh
from weingarten.mesh import Mesh
from weingarten.metrics.protocol import EXACT, PUBLISHED

PARTS = ("plate", 'ball <b>&"x')
EXACTLY, SHIFTED, POISSON, ODD = "exactly", "shifted", "poisson", "odd<i>&'"
SHIFT = 0.06
"""Of the contender `shifted`, along z, in the unit of the file."""
EVIL = "<script>document.title = 'broken in'</script> & \"more\""
STEPS = 40
TERMS = {"eikonal": 50.0, "off_diagonal_weingarten": 10.0}


def as_mesh(shape: trimesh.Trimesh) -> Mesh:
    return Mesh(np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int64))


def truths() -> dict[str, Mesh]:
    plate = as_mesh(trimesh.creation.box((4, 3, 1)).subdivide().subdivide())
    return {PARTS[0]: plate, PARTS[1]: as_mesh(trimesh.creation.icosphere(4))}


def rough(mesh: Mesh, size: float) -> Mesh:
    """The mesh with all vertices moved at random."""
    return Mesh(mesh.vertices + np.random.default_rng(0).normal(0, size, mesh.vertices.shape), mesh.faces)


def make(folder: Path, judged: bool = True) -> Path:
    """Two parts, two seeds; one contender is the truth, one is shifted, one has no curves, one has failed."""
    store, truth_folder = Store(folder), folder / "given"
    truth_folder.mkdir(parents=True)
    for number, (part, truth) in enumerate(truths().items()):
        path = truth_folder / f"{number}.ply"
        write_mesh(path, truth)
        meshes = {
            EXACTLY: truth,
            SHIFTED: Mesh(truth.vertices + np.array([0, 0, SHIFT]), truth.faces),
            POISSON: rough(truth, 0.01),
        }
        for seed in (0, 1):
            for name, mesh in meshes.items():
                entry = made(store.entry(part, name, seed), mesh)
                entry.write_fit(record(part, name, seed, path))
                if name != POISSON:
                    write_curve(entry.curve_path, constant=name == SHIFTED, seed=seed)
                if judged:
                    entry.write_figures(figures(mesh, truth))
            entry = made(store.entry(part, ODD, seed), None)
            failed = {"status": "failed", "error": EVIL, "seconds": None}
            entry.write_fit(record(part, ODD, seed, path) | failed)
        (folder / "truths").mkdir(exist_ok=True)
        ceiling = replace(PUBLISHED, samples=2000).ceiling(truth).values()
        store.write_truth(part, {"protocol": "published-1", "ceiling": ceiling})
    return folder


def made(entry: Entry, mesh: Mesh | None) -> Entry:
    entry.folder.mkdir(parents=True)
    if mesh is not None:
        write_mesh(entry.mesh_path, mesh)
    return entry


def record(part: str, name: str, seed: int, truth: Path) -> dict:
    settings = {"kind": "poisson", "depth": 8} if name == POISSON else neural(name)
    return {
        "part": part,
        "contender": name,
        "seed": seed,
        "settings": settings,
        "scan": {"points": 30000},
        "truth": str(truth),
        "device": "cpu",
        "version": "0.1.0",
        "commit": "0123abc",
        "machine": "A machine, 2 cores",
        "date": f"2026-01-0{1 + seed}",
        "status": "done",
        "seconds": 12.5,
        "cpu_seconds": 20.0,
        "notes": ["A remark <u>of the fit</u>."] if name == SHIFTED else [],
    }


def neural(name: str) -> dict:
    knots = [[0.0, 10.0]] if name == SHIFTED else [[0.0, 10.0], [0.5, 0.0]]
    return {"kind": "neural", "method": "odw", "shape": "linear", "knots": knots, "steps": STEPS}


def write_curve(path: Path, constant: bool, seed: int) -> None:
    """The loss falls by one power of ten; the weight of the last term is constant or falls to zero."""
    names = list(TERMS)
    with path.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(
            ["step", "progress", "rate", "loss", "seconds", *names, *(f"weight_{n}" for n in names)]
        )
        for step in range(STEPS):
            t = step / STEPS
            weight = 10.0 if constant else max(0.0, 10 * (1 - 2 * t))
            writer.writerow([step, t, 5e-4, 100 * (1 + seed) * 10**-t, 0.01, 0.5, 2.0, 50.0, weight])


def figures(mesh: Mesh, truth: Mesh) -> dict:
    found = [
        replace(PUBLISHED, samples=2000).evaluate(mesh, truth),
        replace(EXACT, samples=2000, edge_samples=500).evaluate(mesh, truth),
    ]
    values = {one.protocol: one.as_dict() for one in found}
    return json.loads(json.dumps(values))
