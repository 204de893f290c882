"""`weingarten bench` and `weingarten reproduce` as subprocesses, on small parts and few steps."""

import csv
import json
import os
import signal
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
import trimesh

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[1] / "bench"))
from command import Started, run
from here import Here, judge_by_few

from weingarten.cli.main import main
from weingarten.reproduce import figure_regimes

SMALL = ["--points-per-step", "200", "--resolution", "16", "--points", "1000", "--sharp", "off"]
SHORT = ["--steps", "30", *SMALL]
"""Handles of a field of so few steps are many, and to undo them takes several times as long as the fit."""


@pytest.fixture
def data(tmp_path: Path) -> Path:
    folder = tmp_path / "data"
    folder.mkdir()
    trimesh.creation.box((3, 2, 1)).export(folder / "block.stl")
    trimesh.creation.cylinder(1.0, 1.5).export(folder / "drum.stl")
    return folder


def rows(out: Path) -> list[dict[str, str]]:
    with (out / "results.csv").open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_a_kill_costs_the_running_fit_alone(tmp_path: Path, data: Path, here: Callable):
    out = tmp_path / "out"
    process = Started("bench", data, "--out", out, *SHORT, alone=True)
    deadline = time.monotonic() + 120
    while not list(out.glob("fits/*/*/*/figures.json")):
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    finished = {path: path.stat().st_mtime_ns for path in out.glob("fits/*/*/*/fit.json")}
    code, _, errors = here("bench", data, "--out", out, *SHORT)
    assert code == 0, errors
    assert len(rows(out)) == 2
    for path, written in finished.items():
        assert path.stat().st_mtime_ns == written


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--methods", "nope"], "no method 'nope'"),
        (["--schedules", "nope"], "no schedule 'nope'"),
        (["--schedules", "own,own"], "take part twice"),
        (["--baseline", "nope"], "takes no part"),
        (["--parts", "nope"], "no part 'nope'"),
        (["--shard", "3/2"], "--shard"),
        (["--seeds", "0"], "--seeds"),
        (["--points", "0"], "--points"),
        (["--together", "0"], "--together"),
        (["--weight", "-1", "--schedules", "linear"], "not negative"),
        (["--steps", "0"], "--steps"),
    ],
)
def test_mistakes_end_in_one_sentence(tmp_path: Path, data: Path, options: list[str], sentence: str, capsys):
    assert main(["bench", str(data), "--out", str(tmp_path / "out"), *options]) == 2
    errors = capsys.readouterr().err
    assert sentence in errors
    assert len(errors.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable:
    """The command in this process, where few samples judge a fit: exit code, standard output and error."""
    monkeypatch.setattr("weingarten.many.workers.Workers", Here)
    judge_by_few(monkeypatch)

    def command(*words: object) -> tuple[int, str, str]:
        capsys.readouterr()
        code = main([str(word) for word in words])
        return code, *capsys.readouterr()

    return command


def test_methods_schedules_and_seeds(tmp_path: Path, data: Path, here: Callable):
    out = tmp_path / "out"
    chosen = ["--methods", "odw", "--schedules", "own,none", "--seeds", "2", "--parts", "block"]
    options = [*chosen, "--out", out, *SHORT]
    code, text, errors = here("bench", data, *options)
    assert code == 0, errors
    assert "exact CD" in text
    assert "protocol published-1" in (out / "tables.md").read_text()
    assert "[4/4] block, odw-none, seed 1: done" in errors
    found = rows(out)
    assert [(row["contender"], row["seed"], row["error"]) for row in found] == [
        ("odw", "0", ""),
        ("odw", "1", ""),
        ("odw-none", "0", ""),
        ("odw-none", "1", ""),
    ]
    assert {row["field-1.gradient_error_band"] != "" for row in found} == {True}
    assert "Paired differences from odw" in (out / "tables.md").read_text()
    assert len(json.loads((out / "results.json").read_text())) == 4
    code, text, errors = here("bench", data, *options)
    assert code == 0
    assert "4 of them done before" in errors
    code, _, errors = here("bench", data, *chosen, "--out", out, "--steps", "31", *SMALL)
    assert code == 2
    assert "another settings" in errors
    assert "Traceback" not in errors


def test_the_papers_tables_and_figures(
    tmp_path: Path, data: Path, here: Callable, monkeypatch: pytest.MonkeyPatch
):
    """But for the first figure, small here: the next test makes it as it is."""
    monkeypatch.setattr(figure_regimes, "figure_regimes", partial(figure_regimes.figure_regimes, 80))
    out = tmp_path / "out"
    words = ("reproduce", "tables", "--data", data, "--out", out, "--parts", "block", "--seeds", "1", *SHORT)
    code, text, errors = here(*words)
    assert code == 0, errors
    page = (out / "paper-tables.md").read_text()
    for name in ("Table 1.", "Table 2.", "| step-next |", "| decreasing |", "98.01 (1.46)", "| ceiling |"):
        assert name in page
    assert "Table 1." in text
    found = {row["contender"] for row in rows(out)}
    assert {"odw-constant-w10", "odw-increasing-w10", "odw", "odw-none"} <= found
    weights = json.loads((out / "fits/block/odw-quintic-w10/seed0/fit.json").read_text())["settings"]["knots"]
    assert weights == [[0.0, 10.0], [0.2, 10.0], [0.5, 0.001], [1.0, 0.0]]
    code, _, errors = here(*words)
    assert code == 0
    assert f"{len(found)} of them done before" in errors
    code, text, errors = here("reproduce", "figures", *words[2:8], *SHORT)
    assert code == 0, errors
    assert f"{len(found) - 1} of them done before" in errors
    made = sorted(path.name for path in (out / "figures").iterdir())
    names = ("1-curvature-regimes", "2-schedules", "3-comparison", "4-schedules")
    assert made == [f"figure-{name}.{form}" for name in names for form in ("png", "svg")]
    assert all(f"{out}/figures/{name}" in text for name in made)


def test_figures_without_parts_and_with_wrong_ones(tmp_path: Path, data: Path, here: Callable):
    out = tmp_path / "out"
    code, _, errors = run("reproduce", "figures", "--out", out)
    assert code == 0
    assert "Figure 3" in errors
    assert len(list((out / "figures").iterdir())) == 6
    code, _, errors = here("reproduce", "figures", "--out", tmp_path / "b", "--data", tmp_path / "nowhere")
    assert code == 2
    assert len(errors.strip().splitlines()) == 1
    assert not (tmp_path / "b").exists()
    (tmp_path / "c").write_text("")
    code, _, errors = here("reproduce", "figures", "--out", tmp_path / "c")
    assert code == 2
    assert "cannot be made" in errors
