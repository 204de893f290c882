"""Which parts a folder holds."""

import numpy as np
import pytest

from weingarten.bench.parts import parts_in
from weingarten.errors import InputError, OptionError
from weingarten.io.mesh import write_mesh
from weingarten.samples.parts import part_mesh


@pytest.fixture
def folder(tmp_path):
    for name in ("block", "bracket"):
        write_mesh(tmp_path / f"{name}.ply", part_mesh(name))
    (tmp_path / "index.csv").write_text("id\nblock\n")
    (tmp_path / "README.md").write_text("no mesh")
    (tmp_path / ".hidden.ply").write_text("no mesh")
    return tmp_path


def test_the_meshes_of_a_folder_by_name(folder):
    assert [part.name for part in parts_in(folder)] == ["block", "bracket"]
    assert [part.name for part in parts_in(folder, ["bracket"])] == ["bracket"]


def test_a_cloud_beside_its_truth_is_the_scan(folder):
    np.savetxt(folder / "block.cloud.xyz", [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]])
    block, bracket = parts_in(folder)
    np.testing.assert_array_equal(block.scan(10, 0), [[0, 1, 2], [3, 4, 5]])
    assert bracket.cloud is None
    assert bracket.scan(10, 0).shape == (10, 3)


def test_a_sampled_scan_depends_on_its_seed_alone(folder):
    part = parts_in(folder)[0]
    np.testing.assert_array_equal(part.scan(10, 3), part.scan(10, 3))
    assert (part.scan(10, 3) != part.scan(10, 4)).any()


def test_a_cloud_in_a_mesh_format_is_no_truth(folder):
    write_mesh(folder / "block.cloud.ply", part_mesh("block"))
    assert [part.name for part in parts_in(folder)] == ["block", "bracket"]


@pytest.mark.parametrize(
    ("made", "sentence"),
    [
        ("block.stl", "two meshes of block"),
        ("flange.cloud.xyz", "whose mesh is not in"),
    ],
)
def test_files_that_do_not_fit_together(folder, made, sentence):
    (folder / made).write_text("0 0 0\n")
    with pytest.raises(InputError, match=sentence):
        parts_in(folder)


def test_no_folder_no_mesh_no_such_part(folder, tmp_path):
    with pytest.raises(InputError, match="There is no folder"):
        parts_in(tmp_path / "nowhere")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="holds no mesh"):
        parts_in(tmp_path / "empty")
    with pytest.raises(OptionError, match="no part 'flange'"):
        parts_in(folder, ["block", "flange"])
