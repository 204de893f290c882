"""Processes side by side: each job once, a death takes nothing with it, threads are those asked for."""

import os
import sys
from pathlib import Path

import pytest

from weingarten.many.runner import Several, run, shared
from weingarten.many.threads import Threads
from weingarten.many.workers import Workers


@pytest.fixture
def jobs(monkeypatch: pytest.MonkeyPatch):
    """The module of the test's jobs, importable from any process."""
    monkeypatch.syspath_prepend(Path(__file__).parent)
    import jobs_of_tests

    yield jobs_of_tests
    sys.modules.pop("jobs_of_tests")


def test_two_processes_do_each_job_once_and_one_dies_alone(tmp_path: Path, jobs):
    todo = [jobs.Errand(tmp_path, name) for name in ("slow", "die", "fail", "raise", "last")]
    workers, diary = Workers(os.getpid, 2, Threads(1)), jobs.Diary()
    with workers.working():
        run(todo, [[job] for job in todo], Several(diary, jobs.Diary()), workers)
    assert sorted(diary.ended) == sorted(diary.begun) == sorted(job.name for job in todo)
    assert "died" in todo[1].error
    assert todo[2].error == "None is too hard."
    assert todo[3].error == "ValueError: unforeseen"
    assert not todo[0].error, "its process was another one"
    for job in (todo[0], todo[4]):
        assert job.record["threads"] == 1
        assert len((job.folder / "calls").read_text().split()) == 1


def test_variables_are_put_back(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    monkeypatch.delenv("MKL_NUM_THREADS", raising=False)
    with Threads(3).inherited():
        assert os.environ["OMP_NUM_THREADS"] == os.environ["MKL_NUM_THREADS"] == "3"
    assert os.environ["OMP_NUM_THREADS"] == "7"
    assert "MKL_NUM_THREADS" not in os.environ
    with Threads().inherited():
        assert os.environ["OMP_NUM_THREADS"] == "7"


def test_shares_are_all_of_it_and_nothing_twice():
    found = [shared("abcdefgh", (i, 3)) for i in (1, 2, 3)]
    assert sorted(name for own in found for name in own) == list("abcdefgh")
