"""A run folder has one writer, and any number of readers; a dead writer stands in nobody's way."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from small import small_cloud, small_settings

from weingarten.cli.main import main
from weingarten.errors import BusyError, OutputError
from weingarten.fit.lock import NAME, held
from weingarten.fit.run_folder import opened
from weingarten.io.cloud_file import write_cloud
from weingarten.observer import Observer
from weingarten.reconstruction import reconstruct

HOLDING = "import sys, time; from pathlib import Path; from weingarten.fit.lock import held\n"
HOLDING += "with held(Path(sys.argv[1])): print('held', flush=True); time.sleep(60)"


@pytest.fixture
def other(tmp_path):
    """Another process that holds the folder."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDING, str(tmp_path)], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.communicate()


def test_a_second_writer_is_told_who_the_first_is(other, tmp_path):
    with pytest.raises(BusyError, match=f"in use by process {other.pid} on "), held(tmp_path):
        raise AssertionError


def test_the_lock_of_a_killed_process_is_free(other, tmp_path):
    other.send_signal(signal.SIGKILL)
    other.wait()
    assert (tmp_path / NAME).exists()
    with held(tmp_path):
        assert str(os.getpid()) in (tmp_path / NAME).read_text()
    assert not (tmp_path / NAME).exists()


def test_one_at_a_time_within_a_process(tmp_path):
    """A hundred threads that ask again and again: never two within, and each comes in."""
    inside, most, came = [0], [0], []

    def writer(number: int) -> None:
        while True:
            try:
                with held(tmp_path):
                    inside[0] += 1
                    most[0] = max(most[0], inside[0])
                    came.append(number)
                    inside[0] -= 1
                return
            except BusyError:
                continue

    threads = [threading.Thread(target=writer, args=(number,)) for number in range(20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    assert sorted(came) == list(range(20))
    assert most == [1]


def test_no_link_is_followed(tmp_path):
    (tmp_path / "precious").write_text("kept")
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / NAME).symlink_to(tmp_path / "precious")
    with pytest.raises(OutputError), held(tmp_path / "run"):
        raise AssertionError
    assert (tmp_path / "precious").read_text() == "kept"


def test_a_fit_is_refused_where_another_one_is_kept_and_read_meanwhile(tmp_path, capsys):
    """The command's second fit ends in one sentence; `mesh` reads what the first has kept so far."""
    write_cloud(tmp_path / "a.npy", small_cloud())
    run, out = tmp_path / "run", tmp_path / "b.ply"
    codes: list[int] = []

    class Second(Observer):
        def step(self, record, steps, seconds) -> None:
            if record.step == 2:
                codes.append(main(["fit", str(tmp_path / "a.npy"), "-o", str(out), "--run", str(run)]))
                codes.append(main(["mesh", str(run), "-o", str(out), "--resolution", "24"]))
                opened(run)

    reconstruct(small_cloud(), small_settings(), run_folder=run, observer=Second())
    assert codes == [2, 0]
    error = capsys.readouterr().err
    assert f"{run} is in use by process {os.getpid()}" in error
    assert "Traceback" not in error
    assert out.exists()
    assert not (run / NAME).exists()
