"""A run folder is looked at as it is, whole or half written, and as it becomes."""

import json
import os
import shutil
import time
from pathlib import Path

import numpy as np
import pytest

from weingarten.errors import CheckpointError, InputError
from weingarten.fit import history
from weingarten.mesh import Mesh
from weingarten.view.exhibit import Exhibit
from weingarten.view.item import opened
from weingarten.view.primitives import primitives_in
from weingarten.view.run import Run
from weingarten.view.status import ENDED, RUNNING, SILENT


@pytest.fixture
def own(run_folder, tmp_path) -> Path:
    """A copy to be changed."""
    return Path(shutil.copytree(run_folder, tmp_path / "own.run"))


def test_an_ended_run_has_a_final_mesh_and_all_steps(run_folder):
    run = Run(run_folder)
    look = run.look()
    assert look.final
    assert look.steps == tuple(history.steps_kept(run_folder / history.FOLDER))
    assert look.status is not None
    assert (look.status.kind, look.status.text) == (ENDED, "Fitted, 40 steps.")
    assert len(look.curve["loss"]) == 40
    assert any("Points to mesh" in fact for fact in look.facts)
    assert run.look().version == look.version


def test_the_last_snapshot_is_the_final_field(run_folder):
    run = Run(run_folder)
    final, last = run.surface(None), run.surface(40)
    assert final.field is not None
    assert last.field is not None
    places = run.cloud.points[:200]
    np.testing.assert_array_equal(final.field(places).distance, last.field(places).distance)
    assert np.abs(last.field(last.mesh.vertices).distance).mean() < 0.01 * run.frame.scale
    box = run.box
    assert box is not None
    assert (box.lower < run.cloud.points.min(axis=0)).all()
    assert (box.upper > run.cloud.points.max(axis=0)).all()


def test_a_run_without_a_summary_goes_on_or_is_silent(own):
    (own / "summary.json").unlink()
    os.utime(own / "checkpoint.safetensors")
    look = Run(own).look()
    assert look.final == ""
    assert look.status is not None
    assert look.status.kind == RUNNING
    old = time.time() - 3600
    os.utime(own / "checkpoint.safetensors", (old, old))
    run = Run(own)
    assert run.look().status.kind == SILENT  # pyright: ignore[reportOptionalMemberAccess]
    (own / "summary.json").write_text("{")
    assert run.look().final == ""
    (own / "summary.json").write_text(json.dumps({"steps": 39}))
    assert run.look().final == ""
    (own / "summary.json").write_text(json.dumps({"steps": 40}))
    assert run.look().final


def test_files_that_vanish_or_break_are_survived(own):
    run = Run(own)
    before = run.look()
    (own / "checkpoint.safetensors").write_bytes(b"half")
    broken = run.look()
    assert broken.status is not None
    assert "corrupted" in broken.status.text
    assert broken.version == before.version
    shutil.rmtree(own)
    assert run.look().status is not None
    state = Exhibit(run, 1000).state()
    assert state["steps"] == []
    with pytest.raises((CheckpointError, InputError)):
        run.surface(0)
    with pytest.raises(InputError):
        run.surface(None)


def test_another_fit_in_the_folder_is_another_version(own, run_folder, tmp_path):
    import exhibits

    run = Run(own)
    before = run.look()
    exhibits.run(own, steps=4)
    after = run.look()
    assert after.version != before.version
    assert after.status is not None
    assert after.status.of == 4


def test_a_snapshot_of_another_network_is_an_error_of_the_user(own):
    from safetensors.numpy import save_file

    save_file({"weight": np.zeros(3, dtype=np.float32)}, own / history.FOLDER / "0000003.safetensors")
    with pytest.raises(InputError, match="another network"):
        Run(own).surface(3)


def test_primitives_are_those_of_this_mesh(own):
    run = Run(own)
    mesh = run.surface(None).mesh
    assert run.surface(None).primitives is None
    labels = np.full(len(mesh.vertices), -1, dtype=np.int32)
    labels[:100] = 1
    np.save(own / "labels.npy", labels)
    rows = [{"number": 0, "kind": "plane"}, {"number": 1, "kind": "cylinder", "side": "hole", "radius": 4.0}]
    before = run.look().final
    (own / "primitives.json").write_text(json.dumps({"primitives": rows}))
    assert run.look().final != before
    known = run.surface(None).primitives
    assert known is not None
    assert known.names == ("0 plane", "1 cylinder hole, r 4")
    assert known.legend() == [(2, "1 cylinder hole, r 4")]
    said = opened(Exhibit(run, 60_000).scene(None))[0]
    assert said["colourings"][-1] == ["primitives", "Primitives"]
    assert primitives_in(own, Mesh(mesh.vertices[:-1], mesh.faces[:0])) is None
    np.save(own / "labels.npy", labels + 7)
    assert primitives_in(own, mesh) is None
    np.save(own / "labels.npy", np.array([{}], dtype=object), allow_pickle=True)
    assert primitives_in(own, mesh) is None
