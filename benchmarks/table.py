"""A table of text: the first column to the left, the others to the right."""


def table(headings: list[str], rows: list[list[str]]) -> str:
    """The headings and the rows, each column as wide as its widest cell."""
    widths = [max(map(len, column)) for column in zip(headings, *rows, strict=True)]
    lines = []
    for cells in [headings, *rows]:
        first = f"{cells[0]:<{widths[0]}}"
        others = [f"{cell:>{width}}" for cell, width in zip(cells[1:], widths[1:], strict=True)]
        lines.append("  ".join([first, *others]).rstrip() + "\n")
    return "".join(lines)
