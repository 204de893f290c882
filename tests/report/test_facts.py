"""What the page says of a benchmark, from records alone; and which meshes it shows."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
import benchmark as tiny

from weingarten.bench.metric import EXACT_METRICS, METRICS
from weingarten.bench.results import results
from weingarten.bench.store import Store
from weingarten.errors import InputError
from weingarten.mesh import Mesh
from weingarten.report.distributions import CEILING, distributions, rows_of
from weingarten.report.facts import NONE, facts
from weingarten.report.gallery import figures_beside, part_view
from weingarten.report.page import names_of, opened, parts_of
from weingarten.report.sources import finite, mesh_of, shown_fits, truth_of


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tiny.make(tmp_path_factory.mktemp("bench") / "tiny")


@pytest.fixture(scope="module")
def found(folder: Path) -> list:
    return results(Store(folder))


def test_facts_of_the_records(found: list):
    said = facts(found, parts_of(found), names_of(found))
    assert said.sentence == "4 contenders on 2 parts, seeds 0 and 1: 16 fits, 4 of them failed."
    conditions = dict(said.conditions)
    assert conditions["Scan"] == "30,000 points sampled from the truth"
    assert conditions["weingarten"] == "0.1.0 (0123abc)"
    assert conditions["Fitted"] == "2026-01-01 to 2026-01-02"
    assert [(one.sentence, len(one.fits)) for one in said.failures] == [(tiny.EVIL, 4)]
    assert said.unjudged == 0


def test_settings_are_common_or_told_apart(found: list):
    settings = facts(found, parts_of(found), names_of(found)).settings
    assert ("method", "odw") in settings.common
    assert ("steps", "40") in settings.common
    assert settings.columns == ("kind", "weight, t : w")
    rows = {row[0]: row[1:] for row in settings.rows}
    assert rows[tiny.POISSON] == ("poisson", NONE)
    assert rows[tiny.EXACTLY] == ("neural", "0 : 10, 0.5 : 0")
    assert rows[tiny.SHIFTED] == ("neural", "0 : 10")


def test_distributions_have_a_row_a_contender_and_the_ceiling(found: list):
    names = names_of(found)
    rows = rows_of(METRICS[1], found, names)
    assert [row.name for row in rows] == [*names, CEILING]
    counts = {row.name: len(row.values) for row in rows}
    assert counts == {tiny.EXACTLY: 4, tiny.ODD: 0, tiny.POISSON: 4, tiny.SHIFTED: 4, CEILING: 2}
    chamfer = next(row for row in rows_of(EXACT_METRICS[0], found, names) if row.name == tiny.SHIFTED)
    assert chamfer.titles[0].endswith(f", seed 0: {chamfer.values[0]:.3f}")
    plots = distributions(found, names)
    assert {plot.protocol for plot in plots} == {"published-1", "exact-1"}
    watertight = next(plot for plot in plots if plot.title == "watertight")
    assert "4 of 4" in watertight.svg


def test_a_fit_with_a_mesh_is_shown_rather_than_one_without(folder: Path, found: list, tmp_path: Path):
    shown = shown_fits(found, tiny.PARTS[0], names_of(found))
    assert [(one.contender, one.seed) for one in shown] == [(name, 0) for name in names_of(found)]
    other = tiny.make(tmp_path / "tiny")
    (Store(other).entry(tiny.PARTS[0], tiny.SHIFTED, 0).mesh_path).unlink()
    again = shown_fits(results(Store(other)), tiny.PARTS[0], names_of(found))
    assert {one.contender: one.seed for one in again}[tiny.SHIFTED] == 1


def test_truths_that_are_gone_or_changed_are_named(found: list, tmp_path: Path):
    store = Store(tiny.make(tmp_path / "tiny"))
    fits = shown_fits(results(store), tiny.PARTS[0], names_of(found))
    truth, note = truth_of(store, fits)
    assert truth is not None
    assert note == ""
    store.write_truth(tiny.PARTS[0], {"sha256": "0" * 64})
    assert "has changed" in truth_of(store, fits)[1]
    store.write_truth(tiny.PARTS[0], {})
    path = Path(fits[0].fit["truth"])
    path.write_bytes(path.read_bytes()[:200])
    assert "Errors cannot be drawn" in truth_of(store, fits)[1]
    path.unlink()
    assert str(path) in truth_of(store, fits)[1]
    assert "do not say" in truth_of(store, [])[1]
    fits[0].entry.mesh_path.unlink()
    assert mesh_of(fits[0])[0] is None


def test_vertices_that_nothing_uses_may_be_anything():
    mesh = tiny.truths()[tiny.PARTS[0]]
    assert finite(mesh) is mesh
    nowhere = np.full((1, 3), np.nan)
    spoilt = Mesh(np.concatenate([nowhere, mesh.vertices]), mesh.faces + 1)
    assert np.array_equal(finite(spoilt).corners, mesh.corners)


def test_a_part_without_truth_is_shown_all_the_same(tmp_path: Path):
    store = Store(tiny.make(tmp_path / "tiny"))
    found = results(store)
    (tmp_path / "tiny" / "given" / "0.ply").unlink()
    view = part_view(store, found, tiny.PARTS[0], names_of(found), 500)
    assert "no longer there" in view.note
    assert view.truth is None
    assert view.scale is None
    cards = {card.contender: card for card in view.cards}
    assert cards[tiny.SHIFTED].shaded is not None
    assert cards[tiny.SHIFTED].error is None
    assert cards[tiny.SHIFTED].scene is not None
    assert cards[tiny.ODD].note == tiny.EVIL
    for card in cards.values():
        store.entry(tiny.PARTS[0], card.contender, 0).mesh_path.unlink(missing_ok=True)
        store.entry(tiny.PARTS[0], card.contender, 1).mesh_path.unlink(missing_ok=True)
    assert all(
        card.scene is None for card in part_view(store, found, tiny.PARTS[0], names_of(found), 500).cards
    )


def test_errors_of_a_part_are_on_one_scale_and_figures_beside_them(folder: Path, found: list):
    view = part_view(Store(folder), found, tiny.PARTS[0], names_of(found), 500)
    assert view.side == pytest.approx(4)
    assert view.scale is not None
    assert 0.004 <= view.scale.end <= 0.1
    cards = {card.contender: card for card in view.cards}
    assert cards[tiny.SHIFTED].error != cards[tiny.EXACTLY].error
    assert cards[tiny.SHIFTED].remarks == ("A remark <u>of the fit</u>.",)
    assert [protocol for protocol, _ in cards[tiny.EXACTLY].figures] == ["published-1", "exact-1"]
    assert cards[tiny.ODD].figures == ()
    exact = dict(figures_beside(shown_fits(found, tiny.PARTS[0], [tiny.EXACTLY, tiny.SHIFTED]))[0])["exact-1"]
    shown = {figure.label: figure for figure in exact}
    assert shown["CD"].best
    assert shown["CD"].text == "0.000 ×10⁻³"
    assert shown["watertight"].text == "yes"
    assert not shown["watertight"].best


def test_folders_that_hold_no_finished_fit(tmp_path: Path):
    for path, said in ((tmp_path / "none", "no folder"), (tmp_path, "no benchmark's folder")):
        with pytest.raises(InputError, match=said):
            opened(path)
    (tmp_path / "fits").mkdir()
    with pytest.raises(InputError, match="no finished fit"):
        opened(tmp_path)
