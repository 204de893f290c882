"""What is said while many fits go on, and how long the rest is said to take."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent.parent / "many"))
from jobs_of_tests import Errand

from weingarten.cli.watching import Lines


@pytest.mark.parametrize(("at_once", "left"), [(1, "60 s"), (2, "30 s")])
def test_time_left_is_shared_by_those_that_go_on_at_once(tmp_path: Path, capsys, at_once: int, left: str):
    now = [0.0]
    lines = Lines(lambda: now[0])
    jobs = [Errand(tmp_path, name) for name in "abcd"]
    lines.plan(jobs, jobs)
    for job in jobs[:at_once]:
        lines.begin([job])
    now[0] = 20.0
    lines.end([jobs[0]])
    said = capsys.readouterr().err.splitlines()
    assert said == ["4 fits, 0 of them done before.", f"[1/4] a: done; {left} left for all"]


def test_failures_and_the_last_one(tmp_path: Path, capsys):
    lines = Lines(lambda: 0.0)
    jobs = [Errand(tmp_path, "fail"), Errand(tmp_path, "b")]
    lines.plan(jobs, jobs)
    for job in jobs:
        lines.begin([job])
        Errand.perform([job])
        lines.end([job])
    assert capsys.readouterr().err.splitlines()[1:] == [
        "[1/2] fail: failed: None is too hard.; 0 s left for all",
        "[2/2] b: done",
    ]
