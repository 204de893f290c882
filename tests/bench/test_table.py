"""What the tables say of results made up for the test."""

from pathlib import Path

import pytest

from weingarten.bench.metric import METRICS
from weingarten.bench.rendering import markdown, plain
from weingarten.bench.results import Result
from weingarten.bench.statistics import figures_of
from weingarten.bench.store import Entry
from weingarten.bench.table import BEST, CEILING, SECOND, Table, marked, tables

NC, CD = METRICS[:2]
FIT = {"seconds": 10.0, "cpu_seconds": 20.0}


def result(part: str, contender: str, nc: float, cd: float, seed: int = 0, **more) -> Result:
    values = {NC.key: nc, CD.key: cd, "published-1.ceiling_normal_consistency": 0.99}
    values |= {"published-1.ceiling_chamfer": 0.001, "published-1.excess_chamfer": cd - 0.001}
    return Result(part, contender, seed, more.get("error", ""), values, more.get("flags", ()), ENTRY, FIT)


ENTRY = Entry(Path("nowhere"))
FOUND = [
    result("a", "plain", 0.95, 0.003),
    result("b", "plain", 0.90, 0.005),
    result("a", "fancy", 0.97, 0.002),
    result("b", "fancy", 0.93, 0.002),
    result("a", "third", 0.80, 0.009),
    result("b", "third", 0.80, 0.009),
]


def named(title: str, found: list[Result] = FOUND) -> Table:
    (table,) = [one for one in tables(found) if one.title.startswith(title)]
    return table


def column(table: Table, heading: str) -> dict[str, tuple[str, str]]:
    (index,) = [k for k, name in enumerate(table.columns) if name.startswith(heading)]
    return {row[0].text: (row[index].text, row[index].mark) for row in table.rows}


def test_means_name_their_protocol_and_mark_the_best():
    table = named("Means, protocol published-1")
    assert column(table, "NC, %") == {
        "plain": ("92.50 (3.54)", SECOND),
        "fancy": ("95.00 (2.83)", BEST),
        "third": ("80.00 (0.00)", ""),
        CEILING: ("99.00 (0.00)", ""),
    }
    assert column(table, "CD, ×10⁻³")["fancy"] == ("2.000 (0.000)", BEST)
    assert column(table, "CD over its ceiling")["fancy"] == ("1.000 (0.000)", BEST)


def test_differences_are_from_the_first_unless_another_is_named():
    table = named("Paired differences")
    assert table.title.endswith("from plain")
    cells = column(table, "published-1: CD, ×10⁻³")
    assert cells["fancy"][0] == "-2.000 [-3.000, -1.000] 2 : 0 *"
    assert "plain" not in cells
    (other,) = [one for one in tables(FOUND, "fancy") if one.title.startswith("Paired")]
    assert other.title.endswith("from fancy")


def test_a_failed_fit_is_in_no_mean_and_is_listed():
    failed = Result("b", "fancy", 1, "It was too thin.", {}, (), ENTRY, {})
    table = named("Failed", [*FOUND, failed])
    assert [[cell.text for cell in row] for row in table.rows] == [
        ["b", "fancy", "1", "failed: It was too thin."]
    ]
    assert (
        column(named("Means, protocol published-1", [*FOUND, failed]), "NC, %")["fancy"][0] == "95.00 (2.83)"
    )
    assert column(named("Cost", [*FOUND, failed]), "failed") == {
        "plain": ("0", ""),
        "fancy": ("1", ""),
        "third": ("0", ""),
    }


def test_what_is_odd_of_a_truth_is_listed_once():
    odd = [result("a", name, 0.9, 0.1, flags=("truth-open", "mesh-open")) for name in ("plain", "fancy")]
    rows = [[cell.text for cell in row] for row in named("Failed", odd).rows]
    assert rows.count(["a", "truth", "", "truth-open"]) == 1
    assert sum(row[-1] == "mesh-open" for row in rows) == 2


def test_a_figure_that_does_not_exist_is_said_and_not_averaged():
    holes = [*FOUND]
    holes[2] = Result("a", "fancy", 0, "", {NC.key: None, CD.key: 0.002}, (), ENTRY, FIT)
    table = named("Means, protocol published-1", holes)
    assert column(table, "NC, %")["fancy"][0] == "93.00"
    assert figures_of(holes, "fancy", NC.key) == {"b": {0: 0.93}}
    nothing = [Result("a", "x", 0, "", {NC.key: None}, (), ENTRY, FIT), result("a", "y", 0.9, 0.1)]
    assert column(named("Means, protocol published-1", nothing), "NC, %")["x"] == ("none", "")


@pytest.mark.parametrize(
    ("losses", "marks"),
    [
        ([1.0, 2.0, 3.0], [BEST, SECOND, ""]),
        ([2.0, 1.0, 1.0, None], [SECOND, BEST, BEST, ""]),
        ([1.0], [""]),
        ([None], [""]),
    ],
)
def test_marks(losses, marks):
    assert marked(losses) == marks


def test_every_row_has_a_cell_for_every_column():
    for table in tables(FOUND):
        assert {len(row) for row in table.rows} == {len(table.columns)}


def test_as_text():
    table = named("Means, protocol published-1")
    page, screen = markdown(table), plain(table)
    assert "| fancy | **95.00 (2.83)** |" in page
    assert "| plain | <u>92.50 (3.54)</u> |" in page
    assert "**" not in screen
    lines = [line for line in screen.splitlines() if line.startswith("  ")]
    assert len({len(line) for line in lines}) == 1


def test_no_results_no_tables():
    assert tables([]) == []
