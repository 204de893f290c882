"""A benchmark from beginning to end: every fit made, every mesh judged, everything tabulated."""

from pathlib import Path

from weingarten.atomic import replacing
from weingarten.bench.rendering import markdown
from weingarten.bench.results import Result, results, write_results
from weingarten.bench.runner import Plan, run
from weingarten.bench.store import Store
from weingarten.bench.table import Table, tables
from weingarten.many.runner import Crowd, Watcher


def carry_out(
    plan: Plan,
    watcher: Watcher,
    crowd: Crowd,
    baseline: str | None = None,
    retry: bool = False,
    together: int = 1,
) -> list[Table]:
    """Make what is not made yet and write results.csv, results.json and tables.md; the tables.

    What is written holds every fit of the folder, those of other shards and earlier benchmarks too, and is
    written even when the fits are interrupted. crowd: who makes them, within its `working()`. baseline: who
    is compared with. retry, together: as in `runner.run`.

    Raises OptionError where the folder holds other fits.
    """
    jobs = plan.jobs()
    try:
        run(jobs, watcher, retry, crowd, together)
    finally:
        made = tabulate(plan.store, baseline)
    return made


def tabulate(store: Store, baseline: str | None) -> list[Table]:
    """Write what there is; the tables."""
    found = results(store)
    if not found:
        return []
    write_results(store, found)
    made = tables(found, baseline)
    write_tables(store.path / "tables.md", made, found)
    return made


def write_tables(path: Path, made: list[Table], found: list[Result]) -> None:
    """All tables as one Markdown page that says where its figures were taken."""
    places = sorted({f"{one.fit['date']}, commit {one.fit['commit']}, {one.fit['machine']}" for one in found})
    head = "# Benchmark\n\n" + "".join(f"- {place}\n" for place in places) + "\n"
    with replacing(path) as temporary:
        temporary.write_text(head + "\n".join(map(markdown, made)), encoding="utf-8")
