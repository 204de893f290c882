"""A row a part says of the default, its like, Poisson and the best published row what the fits say."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "runs"))
from by_part import parts_table
from kinds import CHAMFER, TOPOLOGY

from weingarten.bench.results import Result
from weingarten.bench.store import Entry


def fit(contender: str, chamfer: float | None, right: bool, seed: int = 0) -> Result:
    values = {CHAMFER: chamfer, TOPOLOGY: None if chamfer is None else right}
    return Result("link", contender, seed, "", dict(values), (), Entry(Path("nowhere")), {})


def shown(found: list[Result]) -> list[str]:
    (row,) = parts_table(found).rows
    return [cell.text for cell in row]


def test_published_rows_are_those_of_other_steps_and_all_are_ranked():
    found = [
        fit("odw-oriented", 2e-4, True),
        fit("odw", 3e-4, False),
        fit("odw-none", 4e-4, True),
        fit("poisson", 5e-4, False),
        fit("siren", 1e-4, False),
        fit("siren@900", 0.5e-4, True),
    ]
    assert shown(found) == [
        "link",
        "0.200 (1 of 1)",
        "3 of 6",
        "0.300–0.400 (1 of 2)",
        "0.500 (0 of 1)",
        "`siren@900` 0.050 (1 of 1)",
    ]


def test_seeds_are_averaged_and_what_has_no_mesh_is_left_out():
    found = [
        fit("odw-oriented", 2e-4, True),
        fit("odw-oriented", 4e-4, False, seed=1),
        fit("odw", None, False),
        fit("siren@900", None, False),
    ]
    assert shown(found) == ["link", "0.300 (1 of 2)", "1 of 1", "–", "–", "–"]
