"""`weingarten report` and its mistakes; the page itself is tested in tests/report."""

from pathlib import Path

import pytest

from weingarten.cli.main import main


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nowhere"], "There is no folder"),
        (
            ["."],
            "is not a benchmark’s folder, for it has no fits, nor a run’s folder, for it has no config.toml",
        ),
        (["run"], "cloud.npy cannot be read"),
        (["run", "-o", "page.txt"], "end its name in .html"),
        (["begun"], "no finished fit"),
        (["begun", "-o", "page.pdf"], "end its name in .html"),
    ],
)
def test_mistakes_end_in_one_sentence(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "begun" / "fits" / "part" / "odw" / "seed0").mkdir(parents=True)
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "config.toml").write_text("steps = 5\n")
    assert main(["report", *words]) == 2
    err = capsys.readouterr().err
    assert err.startswith("weingarten report: ")
    assert said in err
    assert len(err.splitlines()) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["begun", "run"]
    assert not list(tmp_path.rglob("*.html"))


def test_a_place_that_cannot_be_written_is_said_before_the_work(tmp_path: Path, monkeypatch, capsys):
    (tmp_path / "fits").mkdir()
    monkeypatch.setattr("weingarten.report.page.opened", lambda folder: (None, []))
    assert main(["report", str(tmp_path), "-o", str(tmp_path / "none" / "page.html")]) == 2
    assert "does not exist; create it first" in capsys.readouterr().err
