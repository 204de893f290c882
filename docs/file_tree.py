"""The file tree in README.md, one line a file, from the modules' docstrings.

python docs/file_tree.py            write it anew between its two markers
python docs/file_tree.py --check    exit with code 1 when it is out of date
"""

import ast
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "src" / "weingarten"
README = ROOT / "README.md"
BEGIN, END = "<!-- tree:begin -->\n", "<!-- tree:end -->"


def summary(path: Path) -> str:
    """The first paragraph of the module's docstring; empty for a module without one."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split())


def lines(folder: Path, depth: int = 0) -> list[str]:
    """A line for every module, folders after files; `__init__.py` only where it says something."""
    indent = "  " * depth
    rows = [f"{indent}{folder.name}/"]
    for path in sorted(folder.glob("*.py")):
        text = summary(path)
        if text or path.name != "__init__.py":
            rows.append(f"{indent + '  ' + path.name:<30} {text}".rstrip())
    for path in sorted(child for child in folder.iterdir() if any(child.glob("*.py"))):
        rows += lines(path, depth + 1)
    return rows


def main() -> int:
    """Write or check; returns the exit code."""
    old = README.read_text(encoding="utf-8")
    before, rest = old.split(BEGIN)
    after = rest.split(END)[1]
    tree = "\n".join(lines(PACKAGE))
    new = f"{before}{BEGIN}```text\n{tree}\n```\n{END}{after}"
    if "--check" not in sys.argv[1:]:
        README.write_text(new, encoding="utf-8")
    elif new != old:
        sys.stderr.write("The file tree in README.md is out of date; run: make tree\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
