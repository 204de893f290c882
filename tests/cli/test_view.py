"""`weingarten view`: its mistakes, what it says, and how it ends."""

import http.client
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from command import started_anew

from weingarten.cli.main import main
from weingarten.cli.view import invitation
from weingarten.io.cloud_file import write_cloud
from weingarten.io.mesh import write_mesh
from weingarten.samples.parts import part_mesh, sample_part
from weingarten.view.exhibit import Exhibit
from weingarten.view.server import Server
from weingarten.view.subject import still


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nowhere.stl"], "nowhere.stl does not exist"),
        (["."], "is no run folder"),
        (["text.stl"], "text.stl cannot be read"),
        (["text.ply"], "text.ply cannot be read"),
        (["text.doc"], "unknown extension"),
        (["bundled:nothing"], "nothing"),
        (["small.ply", "--points", "nowhere.ply"], "nowhere.ply does not exist"),
        (["small.ply", "--port", "70000"], "--port must be between"),
        (["small.ply", "-o", "page.pdf"], "end its name in .html"),
        (["small.ply", "-o", "none/page.html"], "does not exist; create it first"),
        (["small.ply", "--host", "no such host"], "cannot be listened to"),
        (["broken.run"], "corrupted"),
    ],
)
def test_mistakes_end_in_one_sentence(words, said, tmp_path: Path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name in ("text.stl", "text.ply", "text.doc"):
        (tmp_path / name).write_text("neither mesh nor points")
    write_mesh(tmp_path / "small.ply", part_mesh("block", 16))
    (tmp_path / "broken.run").mkdir()
    (tmp_path / "broken.run" / "checkpoint.safetensors").write_bytes(b"half")
    assert main(["view", *words]) == 2
    err = capsys.readouterr().err
    assert err.startswith("weingarten view: ")
    assert said in err
    assert len(err.splitlines()) == 1


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """A mesh that is read at once."""
    write_mesh(tmp_path / "small.ply", part_mesh("block", 16))
    return tmp_path / "small.ply"


@contextmanager
def serving(path: Path, host: str = "127.0.0.1") -> Iterator[Server]:
    with Server(Exhibit(still(path, None), 1000), host, 0) as server:
        yield server


def test_a_taken_port_is_said(small, capsys):
    with serving(small) as server:
        assert main(["view", str(small), "--port", str(server.server_port)]) == 2
    assert "cannot be listened to" in capsys.readouterr().err


def test_files_are_meshes_or_clouds_by_what_they_hold(tmp_path: Path):
    write_mesh(tmp_path / "mesh.ply", part_mesh("block", 24))
    write_cloud(tmp_path / "cloud.ply", sample_part("block", 500, 0))
    np.savetxt(tmp_path / "cloud.xyz", sample_part("block", 500, 0))
    assert still(tmp_path / "mesh.ply", None).mesh is not None
    for name in ("cloud.ply", "cloud.xyz"):
        found = still(tmp_path / name, None)
        assert found.mesh is None
        assert found.cloud is not None
        assert len(found.cloud.points) == 500
    both = still(tmp_path / "mesh.ply", tmp_path / "cloud.xyz")
    assert both.mesh is not None
    assert both.cloud is not None


def test_over_ssh_the_line_to_type_is_said(small):
    with serving(small) as server:
        port = server.server_port
        there = {"SSH_CONNECTION": "192.0.2.1 50000 192.0.2.9 22", "USER": "ada"}
        assert f"ssh -L {port}:127.0.0.1:{port} ada@192.0.2.9" in "\n".join(invitation(server, there))
        assert len(invitation(server, {})) == 1
    with serving(small, "0.0.0.0") as server:
        assert any("can see this part" in line for line in invitation(server, {}))


def test_ctrl_c_ends_it_quietly(small):
    process = started_anew("view", small)
    assert process.stdout is not None
    port = int(process.stdout.readline().split("127.0.0.1:")[1].split("/")[0])
    link = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    link.request("GET", "/state")
    assert link.getresponse().read().startswith(b"{")
    link.close()
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0
    assert err == ""
