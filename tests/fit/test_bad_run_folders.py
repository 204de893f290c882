"""Run folders and benchmark folders whose files are damaged, or made by somebody who means harm."""

import json
import os
import pickle
import struct
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from safetensors import safe_open
from safetensors.torch import save

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[1] / "io"))
from bad_archives import npy
from small import small_cloud, small_settings

from weingarten.bench.parts import Part
from weingarten.bench.store import Store
from weingarten.errors import CheckpointError, InputError, WeingartenError
from weingarten.fit.curve import read_curve
from weingarten.fit.run_folder import opened
from weingarten.many.going_on import seconds_of
from weingarten.many.records import read
from weingarten.reconstruction import reconstruct
from weingarten.world_field import WorldField

ODD: list[Any] = [
    None,
    -1,
    0,
    1e300,
    float("nan"),
    float("inf"),
    10**400,
    "words",
    [],
    {},
    [[[]]],
    True,
    [1, 2],
    1 << 62,
]


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> dict[str, bytes]:
    """The files of a finished small fit."""
    folder = tmp_path_factory.mktemp("whole")
    reconstruct(small_cloud(), small_settings(), run_folder=folder)
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.fixture
def run(tmp_path, whole) -> Path:
    """A copy of it."""
    for name, content in whole.items():
        (tmp_path / name).write_bytes(content)
    return tmp_path


def loaded(run: Path) -> None:
    """What `mesh RUN` does before it extracts."""
    WorldField.of(opened(run)[0], torch.device("cpu"))


def resumed(run: Path) -> None:
    """What `fit --resume` does."""
    reconstruct(small_cloud(), small_settings(), run_folder=run, resume=True)


def said(act: Callable[[Path], object], run: Path) -> str:
    """Our sentence, if there is one."""
    try:
        act(run)
    except WeingartenError as error:
        return str(error)
    return ""


def kept(run: Path) -> tuple[dict[str, Any], dict[str, torch.Tensor]]:
    """Header and tensors of the checkpoint."""
    with safe_open(run / "checkpoint.safetensors", framework="pt") as file:
        tensors = {name: file.get_tensor(name).clone() for name in file.keys()}  # noqa: SIM118
        return json.loads(file.metadata()["weingarten"]), tensors


def test_every_truncation_and_many_bits(run, whole):
    content = whole["checkpoint.safetensors"]
    path, header = run / "checkpoint.safetensors", 8 + struct.unpack("<Q", content[:8])[0]
    rng = np.random.default_rng(0)
    for at in (0, 1, 7, 8, 9, header - 1, header, header + 1, len(content) - 1):
        path.write_bytes(content[:at])
        with pytest.raises(CheckpointError):
            opened(run)
    for at in rng.integers(0, header, 200).tolist():
        path.write_bytes(content[:at] + bytes([content[at] ^ 1 << at % 8]) + content[at + 1 :])
        try:
            loaded(run)
        except WeingartenError:
            continue
    for size in (0, (1 << 31) - 1, 1 << 63, (1 << 64) - 1):
        path.write_bytes(struct.pack("<Q", size) + content[8:])
        with pytest.raises(CheckpointError):
            opened(run)
    for other in (b"", b"\0" * 500, pickle.dumps([1]), b"PK\x03\x04" + bytes(100), b"{" * 90_000):
        path.write_bytes(other)
        with pytest.raises(CheckpointError):
            opened(run)


def test_every_value_of_the_header(run):
    """Each is replaced by whatever JSON can say; a field is made of nothing that has not been checked."""
    header, tensors = kept(run)
    places = [(header, key) for key in header]
    places += [(header[name], key) for name in ("settings", "frame") for key in header[name]]
    for place, key in places:
        before = place[key]
        for odd in ODD:
            place[key] = odd
            (run / "checkpoint.safetensors").write_bytes(save(tensors, {"weingarten": json.dumps(header)}))
            assert "\n" not in said(loaded, run)
        place[key] = before


def test_tensors_that_are_others(run):
    header, tensors = kept(run)
    for name in tensors:
        for other in (None, torch.zeros(3), tensors[name].double(), torch.zeros(0)):
            changed = tensors | {name: other}
            changed = {key: value for key, value in changed.items() if value is not None}
            (run / "checkpoint.safetensors").write_bytes(save(changed, {"weingarten": json.dumps(header)}))
            if name.startswith("field"):
                try:
                    loaded(run)
                except WeingartenError:
                    continue
    for name in ("generator", next(key for key in tensors if key.startswith("optimiser"))):
        changed = {key: value for key, value in tensors.items() if key != name}
        (run / "checkpoint.safetensors").write_bytes(save(changed, {"weingarten": json.dumps(header)}))
        with pytest.raises(CheckpointError):
            resumed(run)


def bad_clouds(good: bytes) -> dict[str, bytes]:
    """Clouds that are none."""
    return {
        "cut": good[:-1],
        "other": good[:-8] + bytes(8),
        "empty": b"",
        "zip": b"PK\x05\x06" + bytes(18),
        "pickle": pickle.dumps(np.eye(3)),
        "huge": npy("{'descr': '<f8', 'fortran_order': False, 'shape': (6000000000000, 3)}"),
    }


@pytest.mark.parametrize("label", bad_clouds(b""))
def test_the_cloud(run, whole, label):
    (run / "cloud.npy").write_bytes(bad_clouds(whole["cloud.npy"])[label])
    with pytest.raises(CheckpointError, match="run the fit again"):
        opened(run)


@pytest.mark.parametrize("name", ["cloud.npy", "checkpoint.safetensors"])
def test_a_pipe_is_not_waited_for(run, name):
    (run / name).unlink()
    os.mkfifo(run / name)
    with pytest.raises(CheckpointError):
        opened(run)


BAD_CURVES = [
    b"\xff\xfe",
    b"step,\0\n",
    b'"' + b"x" * 200_000,
    b"step,progress,seconds\n0,words,words\n",
    b"\n" * 99,
]


@pytest.mark.parametrize("content", BAD_CURVES, ids=range(len(BAD_CURVES)))
def test_the_loss_curve(run, content):
    (run / "loss.csv").write_bytes(content)
    for act in (resumed, lambda run: seconds_of(run / "loss.csv")):
        assert "delete it" in (said(act, run) or "delete it")
    (run / "loss.csv").write_bytes(content)
    assert read_curve(run / "loss.csv") == {}


@pytest.mark.parametrize(
    "content", [b"[]", b"3", b"{", b"\xff", b"[" * 200_000, b"", b"\0", b'{"a": ' * 5000]
)
def test_a_benchmarks_files(tmp_path, content):
    (tmp_path / "fit.json").write_bytes(content)
    with pytest.raises(InputError):
        read(tmp_path / "fit.json")
    (tmp_path / "pipe.json").unlink(missing_ok=True)
    os.mkfifo(tmp_path / "pipe.json")
    with pytest.raises(InputError):
        read(tmp_path / "pipe.json")


def test_a_benchmarks_cloud(tmp_path):
    path = tmp_path / "clouds" / "part" / "seed0.npy"
    path.parent.mkdir(parents=True)
    for content in bad_clouds(b"").values():
        path.write_bytes(content)
        with pytest.raises(InputError):
            Store(tmp_path).scan(Part("part", tmp_path / "part.stl"), 10, 0)
