"""`weingarten evaluate`: both protocols, ceilings, notes, run folders; test_sample_evaluate.py has more."""

import json
from pathlib import Path

import numpy as np
import pytest
import torch
import trimesh

from weingarten.cli.main import main
from weingarten.fields.siren import Siren
from weingarten.fit import checkpoint
from weingarten.fit.run_folder import opened
from weingarten.io.mesh import read_mesh
from weingarten.metrics import protocol
from weingarten.metrics.exact import Exact
from weingarten.metrics.field_error import Field
from weingarten.metrics.published import Published
from weingarten.reconstruction import reconstruct, remesh
from weingarten.scan.sampling import sample_surface
from weingarten.settings import resolve
from weingarten.world_field import WorldField

EXACT, PUBLISHED, FIELD = Exact(samples=3000, edge_samples=600), Published(samples=3000), Field(samples=2000)


@pytest.fixture(autouse=True)
def few_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    """The command's protocols, with fewer samples than they are known for."""
    for name, small in (("EXACT", EXACT), ("PUBLISHED", PUBLISHED), ("FIELD", FIELD)):
        monkeypatch.setattr(protocol, name, small)


def command(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str, str]:
    """Exit code, standard output, standard error."""
    capsys.readouterr()
    code = main(["evaluate", *map(str, words)])
    return code, *capsys.readouterr()


@pytest.fixture
def box(tmp_path: Path) -> Path:
    path = tmp_path / "box.stl"
    trimesh.creation.box((4, 2, 1)).export(path)
    return path


@pytest.fixture
def larger(tmp_path: Path) -> Path:
    path = tmp_path / "larger.stl"
    trimesh.creation.box((4.02, 2.01, 1.005)).export(path)
    return path


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    """The folder of a small fit of a box, beside which is the box as box.stl."""
    folder = tmp_path_factory.mktemp("runs")
    trimesh.creation.box((4, 2, 1)).export(folder / "box.stl")
    points, _ = sample_surface(read_mesh(folder / "box.stl"), 4000, 0)
    settings = resolve(steps=200, points=200, resolution=48)
    reconstruct(points, settings, device="cpu", run_folder=folder / "box.run")
    return folder / "box.run"


def test_published_stands_beside_its_ceiling(box, larger, capsys):
    code, out, err = command(capsys, larger, box, "--protocol", "published", "--json", "--seed", 1)
    assert (code, err) == (0, "")
    assert json.loads(out) == PUBLISHED.beside_ceiling(read_mesh(larger), read_mesh(box), 1).as_dict()
    _, out, _ = command(capsys, larger, box, "--protocol", "published")
    lines = out.splitlines()
    assert lines[0] == "protocol published-1"
    assert all("  ceiling " in line and "  excess " in line for line in lines[1:])
    assert len({line.index("ceiling") for line in lines[1:]}) == 1


def test_both_are_keyed_by_their_names(box, larger, capsys):
    code, out, _ = command(capsys, larger, box, "--protocol", "both", "--json")
    assert code == 0
    found = json.loads(out)
    assert list(found) == ["exact", "published"]
    assert found["exact"] == EXACT.evaluate(read_mesh(larger), read_mesh(box)).as_dict()
    assert found["published"]["ceiling"] == PUBLISHED.ceiling(read_mesh(box)).values()
    _, out, _ = command(capsys, larger, box, "--protocol", "both")
    assert [line for line in out.splitlines() if not line.startswith("  ")] == [
        "protocol exact-1",
        "",
        "protocol published-1",
    ]
    assert out.splitlines()[18].split() == [
        "unit-cube",
        "length",
        "4",
        "in",
        "the",
        "unit",
        "of",
        "the",
        "input",
    ]


def test_findings_are_notes_and_flags(tmp_path, box, capsys):
    whole = trimesh.creation.box((4000, 2000, 1000))
    trimesh.Trimesh(whole.vertices, whole.faces[1:]).export(tmp_path / "open.stl")
    code, out, err = command(capsys, tmp_path / "open.stl", box, "--protocol", "both", "--json")
    assert code == 0
    for figures in json.loads(out).values():
        assert figures["flags"] == ["mesh-open", "size-mismatch"]
    assert json.loads(out)["exact"]["volume_ratio"] is None
    lines = err.splitlines()
    assert len(lines) == 2
    assert lines[0].startswith("Note: The mesh is not closed")
    assert lines[1].startswith("Note: The mesh is 1e+03 times")


def test_a_truth_without_area_is_one_sentence(tmp_path, box, capsys):
    line = tmp_path / "line.obj"
    line.write_text("v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n")
    assert command(capsys, box, line) == (
        2,
        "",
        "weingarten evaluate: The truth has no face with an area, so there is no surface to compare.\n",
    )


def test_a_run_folder_is_judged_by_its_mesh_and_its_field(run, capsys):
    truth = run.parent / "box.stl"
    code, out, _ = command(capsys, run, truth, "--json", "--seed", 2)
    assert code == 0
    found, true = json.loads(out), read_mesh(truth)
    of_field = found.pop("field")
    assert found == EXACT.evaluate(read_mesh(run / "mesh.ply"), true, 2).as_dict()
    field = WorldField.of(opened(run)[0], torch.device("cpu"))
    assert of_field == FIELD.evaluate(field, true, 2).as_dict()
    assert of_field["protocol"] == "field-1"
    assert 0 < of_field["distance_error_band"] < 0.02
    assert of_field["wrong_sign_box"] < 0.25
    _, out, _ = command(capsys, run, truth, "--protocol", "both", "--json")
    assert list(json.loads(out)) == ["exact", "published", "field"]
    _, out, _ = command(capsys, run, truth)
    assert "\n\nprotocol field-1\n  distance error, band" in out


def test_the_field_of_a_run_folder_is_that_of_its_mesh(run):
    found, points = opened(run)
    mesh, _ = remesh(found, points, torch.device("cpu"), 48)
    field = WorldField.of(found, torch.device("cpu"))
    size = np.ptp(points, axis=0).max()
    assert np.abs(field(mesh.vertices).distance).mean() < 0.002 * size


def test_a_run_folder_without_a_mesh_says_how_to_make_one(run, tmp_path, capsys):
    for name in ("checkpoint.safetensors", "cloud.npy"):
        (tmp_path / name).write_bytes((run / name).read_bytes())
    code, _, err = command(capsys, tmp_path, run.parent / "box.stl")
    assert code == 2
    assert f"weingarten mesh {tmp_path} -o" in err


def test_a_folder_that_is_no_run_is_one_sentence(tmp_path, capsys):
    code, _, err = command(capsys, tmp_path, "bundled:flange")
    assert code == 2
    assert "There is no checkpoint" in err


def test_weights_of_another_network_are_refused(run):
    found, _ = opened(run)
    other = {f"field.{name}": value for name, value in Siren(8, 2, 30.0).state_dict().items()}
    strange = checkpoint.Checkpoint(found.origin, found.step, other, found.extra, {})
    with pytest.raises(checkpoint.CheckpointError, match="network of its own"):
        WorldField.of(strange, torch.device("cpu"))
