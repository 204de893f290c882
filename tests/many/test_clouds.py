"""Every cloud of a folder has a name of its own, and keeps it."""

from pathlib import Path

import pytest

from weingarten.errors import InputError
from weingarten.many.clouds import clouds_in
from weingarten.many.records import make_folder, write


def named(folder: Path, *names: str, out: Path | None = None) -> dict[str, str]:
    """The names that files of these names get."""
    make_folder(folder)
    for name in names:
        (folder / name).touch()
    return {name: path.name for name, path in clouds_in(folder, out or folder / "none").items()}


def test_the_extension_is_left_out_where_it_can_be(tmp_path: Path):
    found = named(tmp_path, "b.ply", "a.xyz", "a.tar.npy", "README.md", ".hidden.ply")
    assert found == {"a.tar": "a.tar.npy", "a": "a.xyz", "b": "b.ply"}


def test_names_that_differ_in_the_extension_alone_keep_it(tmp_path: Path):
    assert named(tmp_path, "a.ply", "a.xyz", "b.ply") == {"a.ply": "a.ply", "a.xyz": "a.xyz", "b": "b.ply"}


def test_a_short_name_is_no_other_ones_long_name(tmp_path: Path):
    found = named(tmp_path, "a.ply", "a.xyz", "a.ply.npy")
    assert found == {name: name for name in ("a.ply", "a.ply.npy", "a.xyz")}


def test_large_and_small_letters_make_no_difference(tmp_path: Path):
    assert set(named(tmp_path, "Part.ply", "part.xyz")) == {"Part.ply", "part.xyz"}


def test_what_was_fitted_under_its_short_name_keeps_it(tmp_path: Path):
    make_folder(tmp_path / "out/a")
    write(tmp_path / "out/a/fit.json", {"cloud": "a.ply"})
    assert named(tmp_path / "in", "a.ply", "a.xyz", out=tmp_path / "out") == {"a": "a.ply", "a.xyz": "a.xyz"}


def test_a_folder_without_clouds_says_so(tmp_path: Path):
    with pytest.raises(InputError, match="holds no cloud"):
        named(tmp_path, "picture.png")
