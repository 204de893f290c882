"""Fits in a process of their own: what is done stays done, and what dies takes nothing with it."""

import json
import os
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

sys.path.insert(0, str(Path(__file__).parent))
from here import Here, judge_by_few

from weingarten.bench.contender import Contender, Neural
from weingarten.bench.parts import Part, parts_in
from weingarten.bench.results import results, write_results
from weingarten.bench.runner import Plan, batches, run
from weingarten.bench.store import Store
from weingarten.errors import FitError, InputError, OptionError
from weingarten.many.job import failure
from weingarten.many.parcel import Parcel, unpack
from weingarten.many.runner import Watcher
from weingarten.many.workers import Workers, last_step, perform
from weingarten.settings import resolve

CONTENDERS = '''
"""Contenders for tests, importable from any process."""

import os
import signal
from dataclasses import dataclass

import numpy as np
import trimesh

from weingarten.bench.contender import Contender, Made
from weingarten.errors import FitError
from weingarten.io.mesh import write_mesh
from weingarten.mesh import Mesh


@dataclass(frozen=True)
class Copyist(Contender):
    """Knows the answer; counts how often it was asked."""

    label: str = "copyist"
    scale: float = 1.0

    @property
    def name(self):
        return self.label

    def description(self):
        return {"kind": "copyist", "scale": self.scale}

    def make(self, scan):
        with (scan.folder / "calls").open("a") as stream:
            stream.write(f"{os.getpid()} {len(scan.points)} {scan.truth is not None}\\n")
        ball = trimesh.creation.icosphere(3)
        mesh = Mesh(np.array(ball.vertices) * self.scale, np.array(ball.faces, dtype=np.int64))
        write_mesh(scan.folder / "mesh.ply", mesh)
        return Made(("a note",), {"copying": 0.1})


class Loser(Copyist):
    def make(self, scan):
        raise FitError("It is too hard.")


class Blunderer(Copyist):
    def make(self, scan):
        return [][1]


class Victim(Copyist):
    def make(self, scan):
        os.kill(os.getpid(), signal.SIGKILL)


class Sluggard(Copyist):
    """Makes nothing at all."""

    def make(self, scan):
        return Made()


@dataclass(frozen=True)
class Cheat(Copyist):
    oracle: bool = True
'''
ORIGIN = {"version": "1", "commit": "c", "machine": "m", "date": "d"}


@pytest.fixture
def cast(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The module of the test's contenders."""
    (tmp_path / "modules").mkdir()
    (tmp_path / "modules" / "cast_of_tests.py").write_text(CONTENDERS)
    monkeypatch.syspath_prepend(tmp_path / "modules")
    import cast_of_tests

    yield cast_of_tests
    sys.modules.pop("cast_of_tests")


@pytest.fixture(autouse=True)
def few_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is judged in this process is judged by fewer samples: their number is not what is tested here."""
    judge_by_few(monkeypatch)


@pytest.fixture
def parts(tmp_path: Path) -> list[Part]:
    data = tmp_path / "data"
    data.mkdir()
    for name in ("one", "two"):
        trimesh.creation.icosphere(3).export(data / f"{name}.ply")
    return parts_in(data)


class Ends(Watcher):
    """Remembers which fits have ended."""

    def __init__(self) -> None:
        self.names: list[tuple[str, str]] = []

    def end(self, batch) -> None:
        self.names += [(job.part.name, job.contender.name) for job in batch]


def carried_out(tmp_path: Path, parts: list[Part], contenders: list[Contender], **more) -> Ends:
    """Run a benchmark of 500 points in tmp_path/out; in processes of its own, where `apart` is true."""
    workers = more.get("workers") or (Workers if more.get("apart", False) else Here)(os.getpid)
    seeds, shard = more.get("seeds", 1), more.get("shard", (1, 1))
    plan = Plan(Store(tmp_path / "out"), parts, contenders, seeds, 500, "cpu", ORIGIN, shard)
    ends = Ends()
    with workers.working():
        run(plan.jobs(), ends, more.get("retry", False), workers, more.get("together", 1))
    return ends


class Elsewhere(Workers):
    """Fits as on a machine that sees no folder of this one."""

    def perform(self, batches, watcher) -> None:
        for batch in batches:
            unpack(Parcel.of(batch).done(perform), batch[0].root)
            watcher.end(batch)


def calls(tmp_path: Path) -> list[list[str]]:
    """What the contenders noted, by process, points and whether they saw the truth."""
    files = sorted((tmp_path / "out").glob("fits/*/*/*/calls"))
    return [line.split() for path in files for line in path.read_text().splitlines()]


def test_every_fit_is_made_judged_and_never_made_again(tmp_path, parts, cast):
    first = carried_out(tmp_path, parts, [cast.Copyist()], apart=True)
    assert first.names == [("one", "copyist"), ("two", "copyist")]
    again = carried_out(tmp_path, parts, [cast.Copyist()], seeds=2)
    assert again.names == first.names, "only the second seed was left"
    made = calls(tmp_path)
    assert len(made) == 4
    assert {(points, truth) for _, points, truth in made} == {("500", "False")}
    assert [process for process, _, _ in made].count(str(os.getpid())) == 2, "the first two were made apart"
    for one in results(Store(tmp_path / "out")):
        assert one.good
        assert one.number("exact-1.chamfer") == pytest.approx(0.0, abs=1e-6)
        assert one.number("exact-1.topology_right") == 1.0
        assert one.fit["notes"] == ["a note"]
        assert one.fit["commit"] == "c"
    first_of_all = results(Store(tmp_path / "out"))[0]
    assert first_of_all.number("published-1.excess_chamfer") == pytest.approx(0.0, abs=1e-4)


def test_fits_of_other_machines_are_those_of_this_one(tmp_path, parts, cast):
    np.savetxt(parts[0].truth.with_name("one.cloud.xyz"), trimesh.creation.icosphere(2).vertices)
    with_cloud = parts_in(parts[0].truth.parent)
    found = []
    for name, crowd in (("here", Here), ("elsewhere", Elsewhere)):
        carried_out(tmp_path / name, with_cloud, [cast.Copyist()], workers=crowd(os.getpid), seeds=2)
        again = carried_out(tmp_path / name, with_cloud, [cast.Copyist()], workers=crowd(os.getpid), seeds=2)
        assert again.names == []
        assert len(calls(tmp_path / name)) == 4
        found.append(results(Store(tmp_path / name / "out")))
    for here, elsewhere in zip(*found, strict=True):
        assert here.values == elsewhere.values
        assert here.fit["truth"] == elsewhere.fit["truth"]
        assert {*here.fit} == {*elsewhere.fit}
    (tmp_path / "elsewhere/out/fits/two/copyist/seed0/figures.json").unlink()
    parts[1].truth.write_text("ply\n")
    with pytest.raises(OptionError, match="not the mesh"):
        carried_out(tmp_path / "elsewhere", with_cloud, [cast.Copyist()], workers=Elsewhere(os.getpid))


def test_what_fails_elsewhere_names_the_files_of_this_machine(tmp_path, parts, cast):
    parts[0].truth.write_text("ply\n")
    carried_out(tmp_path, parts, [cast.Copyist()], workers=Elsewhere(os.getpid))
    one, two = results(Store(tmp_path / "out"))
    assert str(parts[0].truth) in one.error
    assert two.good


def test_figures_that_are_missing_are_taken_without_another_fit(tmp_path, parts, cast):
    carried_out(tmp_path, parts[:1], [cast.Copyist()])
    entry = Store(tmp_path / "out").entry("one", "copyist", 0)
    (entry.folder / "figures.json").unlink()
    assert "not been judged" in results(Store(tmp_path / "out"))[0].error
    carried_out(tmp_path, parts[:1], [cast.Copyist()])
    assert entry.figures
    assert len(calls(tmp_path)) == 1


def test_failures_are_noted_and_the_rest_goes_on(tmp_path, parts, cast):
    troupe = [
        cast.Loser("loser"),
        cast.Victim("victim"),
        cast.Blunderer("blunderer"),
        cast.Sluggard("sluggard"),
        cast.Copyist(),
    ]
    ends = carried_out(tmp_path, parts[:1], troupe, apart=True)
    assert len(ends.names) == 5
    errors = {one.contender: one.error for one in results(Store(tmp_path / "out"))}
    assert errors.pop("copyist") == ""
    assert errors.pop("loser") == "It is too hard."
    assert errors.pop("blunderer") == "IndexError: list index out of range"
    assert "died" in errors.pop("victim")
    assert "mesh.ply" in errors.pop("sluggard")
    assert carried_out(tmp_path, parts[:1], troupe).names == []
    assert len(carried_out(tmp_path, parts[:1], troupe, retry=True, apart=True).names) == 4


def test_a_failure_while_judging_leaves_the_fit(tmp_path, parts, cast):
    carried_out(tmp_path, parts[:1], [cast.Copyist()])
    entry = Store(tmp_path / "out").entry("one", "copyist", 0)
    (entry.folder / "figures.json").unlink()
    plan = Plan(Store(tmp_path / "out"), parts[:1], [cast.Copyist()], 1, 500, "cpu", ORIGIN)
    plan.jobs()[0].note_failure(failure(FitError("It died.")))
    assert entry.fit["status"] == "done"
    assert entry.error == "It died."
    carried_out(tmp_path, parts[:1], [cast.Copyist()], retry=True)
    assert not entry.error
    assert len(calls(tmp_path)) == 1


def test_parts_of_one_contender_and_seed_go_together(tmp_path, parts, cast):
    troupe = [cast.Copyist(), cast.Loser("loser")]
    plan = Plan(Store(tmp_path / "out"), parts, troupe, 2, 500, "cpu", ORIGIN)
    made = batches(plan.jobs(), 2)
    assert [[(job.part.name, job.contender.name, job.seed) for job in batch] for batch in made] == [
        [("one", "copyist", 0), ("two", "copyist", 0)],
        [("one", "loser", 0), ("two", "loser", 0)],
        [("one", "copyist", 1), ("two", "copyist", 1)],
        [("one", "loser", 1), ("two", "loser", 1)],
    ]
    assert len(batches(plan.jobs(), 1)) == 8
    parts[0].truth.write_text("ply\n")
    carried_out(tmp_path, parts, troupe, together=2)
    errors = {(one.part, one.contender): one.error for one in results(Store(tmp_path / "out"))}
    assert errors["two", "copyist"] == ""
    assert errors["two", "loser"] == "It is too hard."
    assert "one.ply" in errors["one", "copyist"]


def test_an_ensemble_makes_what_each_fit_makes_alone(tmp_path, parts):
    short = resolve(steps=20, points=100, resolution=16, sharp=False)
    carried_out(tmp_path, parts, [Neural("alone", short)])
    carried_out(tmp_path, parts, [Neural("together", short)], together=2)
    store = Store(tmp_path / "out")
    for part in ("one", "two"):
        alone, together = store.entry(part, "alone", 0), store.entry(part, "together", 0)
        assert not together.error
        assert together.fit["together"] == 2
        assert together.figures["exact-1"]["chamfer"] == pytest.approx(
            alone.figures["exact-1"]["chamfer"], rel=0.02
        )
        assert together.figures["field-1"]["gradient_error_box"] == pytest.approx(
            alone.figures["field-1"]["gradient_error_box"], rel=0.02
        )


def test_what_befalls_all_that_go_together_is_noted_of_each(tmp_path, parts, cast, monkeypatch):
    def burst(self, scans):
        raise MemoryError("no room")

    monkeypatch.setattr(cast.Copyist, "make_all", burst)
    carried_out(tmp_path, parts, [cast.Copyist()], together=2)
    assert [one.error for one in results(Store(tmp_path / "out"))] == ["MemoryError: no room"] * 2


def test_only_an_oracle_sees_the_truth(tmp_path, parts, cast):
    carried_out(tmp_path, parts[:1], [cast.Copyist(), cast.Cheat("cheat")])
    assert [truth for _, _, truth in calls(tmp_path)] == ["True", "False"]


def test_contenders_of_one_part_and_seed_get_the_same_scan(tmp_path, parts, cast):
    carried_out(tmp_path, parts[:1], [cast.Copyist()], seeds=2)
    scans = [np.load(path) for path in sorted((tmp_path / "out/clouds/one").iterdir())]
    assert len(scans) == 2
    assert (scans[0] != scans[1]).any()
    np.testing.assert_array_equal(scans[1], parts[0].scan(500, 1))


def test_shards_are_all_of_it_and_nothing_twice(tmp_path, parts, cast):
    names = [carried_out(tmp_path, parts, [cast.Copyist()], seeds=2, shard=(i, 3)).names for i in (1, 2, 3)]
    assert sorted(len(own) for own in names) == [1, 1, 2]
    assert len(results(Store(tmp_path / "out"))) == 4


def test_another_fit_in_the_same_place_is_refused(tmp_path, parts, cast):
    carried_out(tmp_path, parts[:1], [cast.Copyist()])
    with pytest.raises(OptionError, match="another settings"):
        carried_out(tmp_path, parts[:1], [cast.Copyist(scale=2.0)])
    trimesh.creation.box((1, 2, 3)).export(parts[0].truth)
    with pytest.raises(OptionError, match="choose another --out"):
        carried_out(tmp_path, parts[:1], [cast.Copyist()])


def test_a_truth_without_a_surface_fails_its_own_fits_alone(tmp_path, parts, cast):
    parts[0].truth.write_text("ply\n")
    carried_out(tmp_path, parts, [cast.Copyist()])
    one, two = results(Store(tmp_path / "out"))
    assert "one.ply" in one.error
    assert two.good


def test_a_mesh_in_another_unit_is_flagged(tmp_path, parts, cast):
    carried_out(tmp_path, parts[:1], [cast.Copyist("metres", 0.001)])
    (one,) = results(Store(tmp_path / "out"))
    assert "size-mismatch" in one.flags


def test_results_as_csv_and_json_say_the_same(tmp_path, parts, cast):
    carried_out(tmp_path, parts, [cast.Copyist(), cast.Loser("loser")])
    store = Store(tmp_path / "out")
    rows, whole = write_results(store, results(store))
    lines = rows.read_text().splitlines()
    entries = json.loads(whole.read_text())
    assert len(lines) == 1 + len(entries) == 5
    assert {entry["error"] for entry in entries} == {"", "It is too hard."}
    at = lines[0].split(",").index("published-1.chamfer")
    assert float(lines[1].split(",")[at]) == entries[0]["figures"]["published-1.chamfer"]
    assert "NaN" not in whole.read_text()


def test_a_damaged_file_is_named(tmp_path, parts, cast):
    carried_out(tmp_path, parts[:1], [cast.Copyist()])
    (tmp_path / "out/fits/one/copyist/seed0/fit.json").write_text("{")
    with pytest.raises(InputError, match=r"fit\.json"):
        results(Store(tmp_path / "out"))


def test_the_last_step_of_a_curve_that_is_being_written(tmp_path):
    curve = tmp_path / "loss.csv"
    assert last_step(curve) is None
    curve.write_text("step,progress\n")
    assert last_step(curve) is None
    curve.write_text("step,progress\n" + "".join(f"{k},0.1\n" for k in range(900)) + "900,0.")
    assert last_step(curve) in (899, 900)
