"""A document whose tables show figures of a benchmark: the same one with the figures there are now.

Rows of methods begin with the name as code, "| `odw` |", and end with LAST cells that come from elsewhere;
those between are the first of the method's row in the benchmark's table. Rows that follow one another are
put in that table's order. All else stays.
"""

from itertools import groupby

from weingarten.bench.table import Table

LAST = 2


def renewed(text: str, table: Table) -> str:
    """The document with the table's figures; rows among which is an unknown name are left as they are."""
    figures = {row[0].text: [cell.text for cell in row[1:]] for row in table.rows}
    ranks = {name: rank for rank, name in enumerate(figures)}
    lines: list[str] = []
    for ours, run in groupby(text.splitlines(), key=lambda line: line.startswith("| `")):
        rows = list(run)
        if ours and all(method_of(row) in ranks for row in rows):
            rows = [filled(row, figures) for row in sorted(rows, key=lambda row: ranks[method_of(row)])]
        lines += rows
    return "\n".join(lines) + "\n"


def method_of(row: str) -> str:
    """The name that it begins with."""
    return row.split("`")[1]


def filled(row: str, figures: dict[str, list[str]]) -> str:
    """The row with its method's figures."""
    cells = [cell.strip() for cell in row.strip().strip("|").split("|")]
    between = len(cells) - 1 - LAST
    return f"| {' | '.join([cells[0], *figures[method_of(row)][:between], *cells[-LAST:]])} |"
