"""`weingarten fit FOLDER -o OUT`: a folder of clouds in, a folder of run folders and a table out."""

import argparse
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from weingarten.cli import campaign
from weingarten.cli.crowd import add_options, crowd_of
from weingarten.errors import InputError, OptionError

if TYPE_CHECKING:
    from weingarten.many.cloud_fit import CloudFit
    from weingarten.many.ledger import Row
    from weingarten.settings import Settings

SHOWN = 40
"""Rows of a table that a person reads on a terminal."""
EXAMPLE = """\
A folder of clouds:
  weingarten fit scans/ -o fitted                 a run folder for each, fitted/NAME/, and fitted/results.csv
  weingarten fit scans/ -o fitted --ray auto      the same on a Ray cluster
  weingarten fit scans/ -o fitted --shard 2/4     the second of four shares, on a machine of its own
What fails is noted and the rest goes on; exit code 1 says that something failed. The same command goes on
after an interruption: what is finished is never made again, what is not goes on from its checkpoint.
"""


def add(verb: argparse.ArgumentParser) -> None:
    """What is for a folder of clouds alone."""
    group = verb.add_argument_group("a folder of clouds")
    add_options(group, alone=False)
    group.add_argument("--shard", metavar="I/N", help="only the I-th of N shares of the clouds")
    group.add_argument("--retry", action="store_true", help="try again what failed before")


def refuse_options(arguments: argparse.Namespace) -> None:
    """Raise OptionError where something was asked of one cloud that is for a folder."""
    for name in ("jobs", "cpus_per_fit", "gpus_per_fit", "ray", "shard", "retry"):
        given = getattr(arguments, name)
        if given is not None and given is not False:
            raise OptionError(
                f"--{name.replace('_', '-')} is for a folder of clouds; {arguments.cloud} is none."
            )


def run(arguments: argparse.Namespace, settings: "Settings", options: list[str]) -> int:
    """Fit all; 1 where any failed. options: that make a fit of one cloud the same fit.

    Raises a WeingartenError that names the option or file at fault.
    """
    from weingarten.atomic import check_writable
    from weingarten.many.ledger import Ledger
    from weingarten.many.records import make_folder
    from weingarten.many.runner import Several, run

    check(arguments)
    out, share = arguments.output, campaign.share(arguments.shard or "1/1")
    crowd = crowd_of(arguments, alone=False)
    named = clouds(arguments, share)
    with crowd.working(), campaign.watching(arguments.quiet) as watcher:
        device = crowd.device(arguments.device)
        jobs = fits(arguments, settings, options, named, device, crowd.threads.count)
        waiting = [[job] for job in jobs if not job.done(arguments.retry)]
        make_folder(out)
        check_writable(out / "results.csv")
        ledger = Ledger(out)
        try:
            run(jobs, waiting, Several(ledger, watcher), crowd)
        finally:
            found = ledger.close()
    own = [row for row in found if row["name"] in named]
    failed = [row for row in own if row["error"]]
    if arguments.json:
        sys.stdout.write((out / "results.json").read_text(encoding="utf-8"))
    elif not arguments.quiet:
        report(out, own, failed)
    return 1 if failed else 0


def check(arguments: argparse.Namespace) -> None:
    """Raise OptionError for what makes no sense of a folder."""
    from weingarten.report.picture import check_picture_format

    for name, given in (("--run", arguments.folder), ("--resume", arguments.resume)):
        if given:
            raise OptionError(
                f"{name} is for one cloud; each of a folder has its run folder in -o, and goes on from there."
            )
    if arguments.oracle is not None:
        raise OptionError("--oracle takes one cloud and its true mesh; of a folder, see `weingarten bench`.")
    if arguments.page is not None:
        raise OptionError(
            "--page is for one cloud; of a folder's fits, `weingarten report OUT/NAME` makes one."
        )
    if arguments.picture is not None:
        check_picture_format(arguments.picture)
        if arguments.picture.parent != Path():
            raise OptionError(
                f"--picture is a file's name within each run folder, for a folder; got {arguments.picture}."
            )
    if arguments.output.exists() and arguments.output.samefile(arguments.cloud):
        raise OptionError(f"-o {arguments.output} is the folder of the clouds; choose another one.")
    if arguments.output.is_file():
        raise OptionError(f"-o {arguments.output} is a file; of a folder of clouds it is a folder.")


def clouds(arguments: argparse.Namespace, share: tuple[int, int]) -> dict[str, Path]:
    """The files of this share, by name. Raises InputError where there are none."""
    from weingarten.many.clouds import clouds_in
    from weingarten.many.runner import shared

    try:
        found = clouds_in(arguments.cloud, arguments.output)
    except OSError as error:
        raise InputError(f"The folder {arguments.cloud} cannot be read: {error.strerror}.") from error
    return dict(shared(list(found.items()), share))


def fits(
    arguments: argparse.Namespace,
    settings: "Settings",
    options: list[str],
    named: dict[str, Path],
    device: str,
    threads: int | None,
) -> "list[CloudFit]":
    """All that are to be there in the end, in order."""
    from weingarten.many.cloud_fit import CloudFit
    from weingarten.report.provenance import machine, origin

    out, picture = arguments.output, None if arguments.picture is None else arguments.picture.name
    where = origin(machine(threads))
    return [
        CloudFit(
            out,
            name,
            path,
            path.stat().st_size,
            settings,
            device,
            asked(path, out / name, options),
            where,
            picture,
        )
        for name, path in named.items()
    ]


def asked(cloud: Path, folder: Path, options: list[str]) -> dict[str, str]:
    """What a fit of a folder is asked for: cloud, mesh, and the command that makes it alone."""
    mesh = folder / "mesh.ply"
    words = ["weingarten", "fit", cloud, "-o", mesh, "--run", folder, *options]
    return {"cloud": str(cloud), "mesh": str(mesh), "command": shlex.join(map(str, words))}


def report(out: Path, own: "list[Row]", failed: "list[Row]") -> None:
    """The table, if it can be read at a glance; and which failed."""
    from weingarten.bench.rendering import plain

    if len(own) <= SHOWN:
        sys.stdout.write(plain(table(own)))
    sys.stdout.write(f"{len(own) - len(failed)} of {len(own)} done; all figures: {out / 'results.csv'}\n")
    for row in failed[:SHOWN]:
        sys.stderr.write(f"{row['cloud']} failed: {row['error']}\n")
    if len(failed) > SHOWN:
        sys.stderr.write(f"… and {len(failed) - SHOWN:,} more: {out / 'results.csv'}\n")


def table(own: "list[Row]"):
    """The figures that a person looks at first."""
    from weingarten.bench.table import Cell, Table

    columns = ("", "seconds", "watertight", "components", "genus", "mean distance", "doubts")
    lines = []
    for row in own:
        if row["status"] != "done":
            lines.append((Cell(row["name"]), Cell(row["status"]), *[Cell("")] * 5))
            continue
        genus = "unknown" if row["genus"] is None else str(row["genus"])
        cells = [f"{row['seconds']:.1f}", "yes" if row["watertight"] else "NO", str(row["components"]), genus]
        cells += [f"{row['distance_mean']:.4g}", str(len(row["doubts"] or ()))]
        lines.append((Cell(row["name"]), *map(Cell, cells)))
    return Table("Fits", "", columns, tuple(lines))
