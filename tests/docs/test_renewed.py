"""The figures of a document's rows come from the benchmark's table, and nothing else is touched."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "runs"))
from renewed import renewed

from weingarten.bench.table import Cell, Table

TABLE = Table(
    "Overview",
    "",
    ("", "steps", "right", "time", "right"),
    tuple(
        tuple(map(Cell, row))
        for row in (("b", "0.1", "5 of 5", "0.2", "4 of 5"), ("a", "0.3", "3 of 5", "0.4", "2 of 5"))
    ),
)
STAYS = """| other | CD |
|---|---:|
| `a` | 9 |

| `a` | 9 | of no table | 1 | 2 |

| method | CD | of | 1 | 2 |
|---|---:|---:|---:|---:|
| `a` | 9 | of another table | 1 | 2 |
| `c` | 9 | of another table | 1 | 2 |
"""
BEFORE = f"""# A document

| method | CD | topology | step | MiB |
|---|---:|---:|---:|---:|
| `a` | 9 | 9 of 9 | 1.00 | 515 |
| `b` | 9 | 9 of 9 | 0.99 | 517 |

Words of `a`.

| method | steps | topology | time | topology | step | MiB |
|---|---:|---:|---:|---:|---:|---:|
| `a` | 9 | 9 of 9 | 9 | 9 of 9 | 2.0 | 600 |

{STAYS}"""
AFTER = f"""# A document

| method | CD | topology | step | MiB |
|---|---:|---:|---:|---:|
| `b` | 0.1 | 5 of 5 | 0.99 | 517 |
| `a` | 0.3 | 3 of 5 | 1.00 | 515 |

Words of `a`.

| method | steps | topology | time | topology | step | MiB |
|---|---:|---:|---:|---:|---:|---:|
| `a` | 0.3 | 3 of 5 | 0.4 | 2 of 5 | 2.0 | 600 |

{STAYS}"""


def test_rows_are_filled_and_ordered_and_all_else_stays():
    assert renewed(BEFORE, "method", TABLE, last=2) == AFTER
    assert renewed(AFTER, "method", TABLE, last=2) == AFTER


def test_all_figures_of_a_row_may_come_from_the_benchmark():
    before = "| other | CD | topology |\n|---|---|---|\n| `a` | 9 | 9 of 9 |\n"
    assert renewed(before, "other", TABLE, last=0).endswith("| `a` | 0.3 | 3 of 5 |\n")
