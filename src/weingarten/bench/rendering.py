"""Tables as text: Markdown for files, aligned columns for a terminal."""

from collections.abc import Callable

from weingarten.bench.table import BEST, SECOND, Table

MARKS: dict[str, Callable[[str], str]] = {
    BEST: lambda text: f"**{text}**",
    SECOND: lambda text: f"<u>{text}</u>",
    "": lambda text: text,
}


def markdown(table: Table) -> str:
    """With title and caption; best bold, second best underlined."""
    rows = [[MARKS[cell.mark](cell.text.replace("|", "\\|")) for cell in row] for row in table.rows]
    lines = [table.columns, ["---"] * len(table.columns), *rows]
    body = "\n".join(f"| {' | '.join(line)} |" for line in lines)
    return f"## {table.title}\n\n{table.caption}\n\n{body}\n"


def plain(table: Table) -> str:
    """With its title; names to the left, figures to the right."""
    lines = [table.columns, *([cell.text for cell in row] for row in table.rows)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    body = [
        "  ".join(
            [line[0].ljust(widths[0]), *(t.rjust(w) for t, w in zip(line[1:], widths[1:], strict=True))]
        )
        for line in lines
    ]
    return "\n".join([table.title, *(f"  {line}".rstrip() for line in body)]) + "\n"
