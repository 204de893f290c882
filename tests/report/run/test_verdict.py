"""What is said first of a fit, and its figures and settings."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))
import one_run

from weingarten.report.run import facts
from weingarten.report.run.source import Run, read_run
from weingarten.report.run.verdict import verdict

SOUND = {
    "watertight": True,
    "components": 1,
    "genus": 1,
    "faces": 1200,
    "self_intersecting": 0,
    "distance_p95": 0.0213,
    "distance_max": 0.25,
    "steps": 60,
    "finished": True,
}


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return read_run(one_run.make(tmp_path_factory.mktemp("runs") / "part"))


def judged(run: Run, trim: float = 0.0, **changes: object):
    return verdict(replace(run, summary=SOUND | changes, settings=run.settings | {"trim": trim}))


def test_a_sound_mesh(finished: Run):
    said = judged(finished)
    assert (said.grade, said.word, said.warnings) == ("good", "Nothing speaks against it", ())
    assert said.sentence == (
        "Watertight, one piece, 1 through-hole (genus 1); 95 % of the points lie within 0.0213 of the mesh, "
        "all within 0.25, in the cloud’s unit."
    )


def test_doubts_are_counted_and_come_before_notes(finished: Run):
    said = judged(finished, notes=["A note."], doubts=["A doubt."], self_intersecting=12)
    assert (said.grade, said.word) == ("look", "To be looked at")
    assert said.sentence.endswith("; 2 doubts.")
    assert [one.kind for one in said.warnings] == ["Doubt", "Doubt", "Note"]
    assert "12 faces of 1,200 pass through others" in said.warnings[0].sentence


def test_pieces_are_to_be_looked_at(finished: Run):
    said = judged(finished, components=3)
    assert said.grade == "look"
    assert "3 pieces" in said.sentence


@pytest.mark.parametrize(("trim", "grade"), [(0.0, "bad"), (2.5, "look")])
def test_an_open_mesh_is_bad_unless_it_was_asked_for(finished: Run, trim: float, grade: str):
    said = judged(finished, trim, watertight=False, genus=None)
    assert said.grade == grade
    assert said.sentence.startswith("Not watertight, one piece; 95 %")
    assert ("--trim-distance 2.5" in said.warnings[0].sentence) == (trim > 0)


def test_an_interrupted_fit_says_so_first(finished: Run):
    said = judged(finished, finished=False, steps=30, doubts=["A doubt."])
    assert (said.grade, said.word) == ("bad", "Interrupted")
    assert "interrupted after step 30 of 60" in said.warnings[0].sentence


def test_a_run_without_mesh_says_so_in_one_sentence(tmp_path: Path):
    run = read_run(one_run.without_mesh(tmp_path / "part"))
    said = verdict(run)
    assert (said.grade, said.warnings) == ("bad", ())
    assert said.sentence.startswith("This run has no mesh: it ended after step 20 of 60, before its surface")


def test_figures_have_units_and_absent_ones_are_left_out():
    found = {one.label: one for one in facts.figures(SOUND | {"volume": 59180.4, "genus": None})}
    assert (found["volume"].text, found["volume"].unit) == ("59,180", "u³")
    assert (found["genus"].text, found["genus"].unit) == ("not defined", "")
    assert found["watertight"].text == "yes"
    assert "mean distance" not in found


def test_settings_that_differ_from_the_preset_come_first_and_say_how(finished: Run):
    rows = facts.settings(finished.settings)
    changed = {row.label: (row.text, row.usual) for row in rows if row.changed}
    assert changed == {"steps": ("60", "800"), "seed": ("3", "0")}
    assert [row.changed for row in rows[:3]] == [True, True, False]
    assert not any(row.changed for row in facts.settings({"preset": "of old", "steps": 5}))


def test_primitives_are_shown_by_whatever_keys_they_have():
    rows = [
        {"kind": "plane", "normal": [0, 0, 1.0], "is_flat": True},
        {"kind": "cone", "half_angle": 0.5236, "more": {"r": None}},
    ]
    keys, shown = facts.primitives(rows)
    assert keys == ["kind", "normal", "is flat", "half angle", "more"]
    assert shown == [["plane", "0, 0, 1", "yes", "–", "–"], ["cone", "–", "–", "0.5236", "r –"]]
