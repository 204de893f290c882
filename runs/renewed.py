"""A document whose tables show figures of a benchmark: the same one with the figures there are now.

A table of the document is known by the first cell of its head. Its rows begin with a name as code,
"| `odw` |", and may end with cells that come from elsewhere; those between are the first of the name's row
in the benchmark's table. Rows that follow one another are put in that table's order. All else stays.
"""

from itertools import groupby

from weingarten.bench.table import Table


def renewed(text: str, head: str, table: Table, last: int) -> str:
    """The document with the table's figures; rows among which is an unknown name are left as they are.

    last: how many cells at the end of a row stay.
    """
    figures = {row[0].text: [cell.text for cell in row[1:]] for row in table.rows}
    ranks = {name: rank for rank, name in enumerate(figures)}
    lines: list[str] = []
    for ours, run in groupby(text.splitlines(), key=lambda line: line.startswith("| `")):
        rows = list(run)
        named = ours and len(lines) > 1 and cells_of(lines[-2])[0] == head
        if named and all(method_of(row) in ranks for row in rows):
            rows = [filled(row, figures, last) for row in sorted(rows, key=lambda row: ranks[method_of(row)])]
        lines += rows
    return "\n".join(lines) + "\n"


def cells_of(row: str) -> list[str]:
    """What is between the bars."""
    return [cell.strip() for cell in row.strip().strip("|").split("|")]


def method_of(row: str) -> str:
    """The name that it begins with."""
    return row.split("`")[1]


def filled(row: str, figures: dict[str, list[str]], last: int) -> str:
    """The row with its name's figures."""
    cells = cells_of(row)
    kept = cells[len(cells) - last :]
    between = len(cells) - 1 - last
    return f"| {' | '.join([cells[0], *figures[method_of(row)][:between], *kept])} |"
