"""A loss curve is read as far as it is written."""

from pathlib import Path

from weingarten.fit.curve import read_curve


def test_files_are_read_as_far_as_they_are_whole(tmp_path: Path):
    path = tmp_path / "loss.csv"
    assert read_curve(path) == {}
    for text in ("", "step,progress,loss\n", "other\n1\n", "step,progress,loss\n0,zero,1\n"):
        path.write_text(text)
        assert read_curve(path) == {}
    path.write_text("step,progress,loss\n0,0,5\n1,0.5,nan\n2,0.7")
    found = read_curve(path)
    assert found["progress"].tolist() == [0, 0.5]
    assert found["loss"][0] == 5
