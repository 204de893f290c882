"""`weingarten fit`: a cloud in, a mesh out."""

import argparse
import json
import shlex
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from weingarten.cli import fit_folder
from weingarten.cli.importing import importing
from weingarten.cli.mesh import SIMPLIFY_HELP, TRIM_HELP
from weingarten.cli.switch import SWITCH
from weingarten.errors import OptionError, OutputError

if TYPE_CHECKING:
    from weingarten.fit.run_folder import RunFolder
    from weingarten.fit.spare_folder import SpareFolder
    from weingarten.reconstruction import Result
    from weingarten.settings import Settings

INTERRUPTED = 130
EXAMPLE = """\
clouds: .ply .xyz .txt .csv .obj .stl .npy .npz .pcd        meshes: .stl .ply .obj .glb .3mf
Lengths are in the cloud's unit; the mesh comes back in the cloud's coordinates.

"""


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "fit",
        help="fit a part to a cloud and write its mesh",
        description="Fit a signed distance field to unoriented points and write its surface.",
        formatter_class=formatter,
        epilog=EXAMPLE + fit_folder.EXAMPLE,
    )
    verb.add_argument("cloud", metavar="CLOUD", type=Path, help="points to fit; or a folder of clouds")
    verb.add_argument(
        "-o", "--output", metavar="MESH", type=Path, required=True, help="mesh to write; or folder"
    )
    verb.add_argument("--preset", default="standard", metavar="NAME", help="standard, fine or paper")
    verb.add_argument("--method", metavar="NAME", help=METHOD_HELP)
    verb.add_argument("--schedule", metavar="NAME", help=SCHEDULE_HELP)
    verb.add_argument("--knots", metavar="T:W,...", help="times in [0,1] and weights (default: schedule's)")
    verb.add_argument("--term", metavar="NAME", help="whose weight this is (default: the curvature term's)")
    verb.add_argument("--stencil", metavar="T:H,...", help="distances of a method by finite differences")
    verb.add_argument("--steps", type=int, metavar="N", help="optimisation steps (default: preset's)")
    verb.add_argument("--rate", type=float, metavar="R", help="greatest learning rate (default: method's)")
    verb.add_argument("--points-per-step", type=int, metavar="N", help="of each kind (default: preset's)")
    verb.add_argument("--sharp", choices=SWITCH, help="vertices on sharp edges or not (default: preset's)")
    verb.add_argument("--trim-distance", type=float, metavar="D", help=TRIM_HELP)
    verb.add_argument("--simplify", type=float, metavar="D", help=SIMPLIFY_HELP)
    verb.add_argument(
        "--resolution",
        type=int,
        metavar="N",
        help="cells along the longest side, up to twice as many for thin walls (default: preset's)",
    )
    verb.add_argument("--seed", type=int, default=0, metavar="N", help="seed of every random draw")
    verb.add_argument("--device", default="auto", metavar="NAME", help="auto, cpu, cuda or mps")
    verb.add_argument(
        "--run",
        type=Path,
        dest="folder",
        metavar="DIR",
        help="keep settings, losses, checkpoint here",
    )
    verb.add_argument("--resume", action="store_true", help="go on from the checkpoint in --run")
    verb.add_argument(
        "--oracle", metavar="TRUTH", help="stop early by distance to this mesh, as the paper does"
    )
    verb.add_argument("--picture", type=Path, metavar="PNG", help="draw the points beside the mesh")
    verb.add_argument("--page", type=Path, metavar="HTML", help="write the page of `weingarten report` too")
    verb.add_argument("--json", action="store_true", help="one JSON object on the standard output")
    verb.add_argument("--quiet", action="store_true", help="no progress")
    fit_folder.add(verb)
    verb.set_defaults(run=run)


METHOD_HELP = (
    "odw, odw-fd, frame-free, smaller-curvature, gaussian, singular-hessian, divergence, odw-paper, flatcad, "
    "neurcadrecon and others, see README.md (default: preset's)"
)
SCHEDULE_HELP = (
    "constant, linear, quintic, step, step-next, increasing or none; or a weight that follows the losses, "
    "kendall, gradnorm, dtp, softadapt, relobralo or discrepancy (default: method's)"
)


def run(arguments: argparse.Namespace) -> int:
    """Fit and write. Raises a WeingartenError that names the option or file at fault."""
    if arguments.cloud.is_dir():
        with importing():
            import weingarten.many.cloud_fit  # noqa: F401
        return fit_folder.run(arguments, settings_of(arguments), repeated(arguments))
    fit_folder.refuse_options(arguments)
    if arguments.resume and arguments.folder is None:
        raise OptionError("--resume needs --run DIR, the folder of the fit to go on with.")
    with importing():
        from weingarten.cli.memory import keep_freed_memory
        from weingarten.cli.mesh_source import load
        from weingarten.cli.progress import progress
        from weingarten.io.mesh import write_mesh
        from weingarten.io.points import read_points
        from weingarten.reconstruction import reconstruct
        from weingarten.report.picture import write_picture

    settings = settings_of(arguments)
    check_places(arguments)
    truth = None if arguments.oracle is None else load(arguments.oracle)
    points = read_points(arguments.cloud)
    keep_freed_memory()
    keeper = keeper_for(arguments)
    observer = progress(arguments.quiet)
    with observer.listening():
        try:
            result = reconstruct(
                points,
                settings,
                device=arguments.device,
                run_folder=keeper,
                resume=arguments.resume,
                truth=truth,
                observer=observer,
            )
            notes = write_mesh(arguments.output, result.mesh)
        except OutputError as error:
            raise OutputError(going_on(error, keeper.keep(), arguments)) from error
        for note in notes:
            observer.note(note)
    if arguments.picture is not None:
        write_picture(arguments.picture, points, result.mesh)
    if arguments.page is not None:
        write_page(keeper, arguments.page)
    if arguments.json:
        sys.stdout.write(json.dumps(as_json(arguments.output, result)) + "\n")
    elif not arguments.quiet:
        sys.stderr.write("\n".join(sentences(arguments.output, result)) + "\n")
    if result.finished:
        return 0
    sys.stderr.write(
        f"Interrupted after step {result.summary.steps} of {result.summary.of_steps}; go on with:\n"
    )
    sys.stderr.write(f"  {resuming(keeper.keep() or keeper.path, arguments)}\n")
    return INTERRUPTED


def going_on(error: OutputError, folder: Path | None, arguments: argparse.Namespace) -> str:
    """What to say of a file that could not be written: where the fit is, and how to go on with it."""
    said = str(error).rstrip(".")
    if folder is None:
        return f"{said}; the fit could not be kept anywhere, make room and start it again."
    return f"{said}; the fit is kept in {folder}, make room and go on with: {resuming(folder, arguments)}"


def resuming(folder: Path, arguments: argparse.Namespace) -> str:
    """The command that goes on with the fit kept in `folder`."""
    return command(arguments, "--run", folder, "--resume")


def settings_of(arguments: argparse.Namespace) -> "Settings":
    """The preset's with what is to differ from them. Raises OptionError."""
    from weingarten.schedules.schedule import parse_knots
    from weingarten.settings import resolve

    return resolve(
        preset=arguments.preset,
        method=arguments.method,
        schedule=arguments.schedule,
        knots=None if arguments.knots is None else parse_knots(arguments.knots),
        term=arguments.term,
        stencil=None if arguments.stencil is None else parse_knots(arguments.stencil),
        seed=arguments.seed,
        steps=arguments.steps,
        points=arguments.points_per_step,
        resolution=arguments.resolution,
        sharp=SWITCH.get(arguments.sharp),
        trim=arguments.trim_distance,
        simplify=arguments.simplify,
        rate=arguments.rate,
    )


def check_places(arguments: argparse.Namespace) -> None:
    """Before the work begins: raise unless the device is there, and all that is to be written can be."""
    from weingarten.device import chosen_device
    from weingarten.io.mesh import check_mesh_path
    from weingarten.report import extra
    from weingarten.report.picture import check_picture_path
    from weingarten.report.template import check_page_path

    chosen_device(arguments.device)
    check_mesh_path(arguments.output)
    if arguments.picture is not None:
        check_picture_path(arguments.picture)
    if arguments.page is not None:
        check_page_path(arguments.page)
        extra.check()


def keeper_for(arguments: argparse.Namespace) -> "RunFolder | SpareFolder":
    """What keeps the fit, with the record of how it is made."""
    from weingarten.device import chosen_device
    from weingarten.fit.run_folder import RunFolder
    from weingarten.fit.spare_folder import SpareFolder
    from weingarten.report.provenance import machine, origin

    kept = () if arguments.folder is None else ("--run", arguments.folder)
    made = {
        "cloud": str(arguments.cloud),
        "mesh": str(arguments.output),
        "command": command(arguments, *kept),
        "device": str(chosen_device(arguments.device)),
        **origin(machine()),
    }
    if arguments.folder is not None:
        return RunFolder(arguments.folder, made)
    return SpareFolder(arguments.output.with_suffix(".run"), made)


def write_page(keeper: "RunFolder | SpareFolder", path: Path) -> None:
    """Write the page about a fit that has come to its end. Raises OutputError."""
    from weingarten.fit.run_folder import RunFolder
    from weingarten.report.run.page import write_run_page

    if isinstance(keeper, RunFolder):
        write_run_page(keeper.path, path)
        return
    with TemporaryDirectory() as folder:
        keeper.lay_out(Path(folder))
        write_run_page(Path(folder), path)


def as_json(output: Path, result: "Result") -> dict[str, object]:
    """Figures, settings and where the mesh went."""
    return {"mesh": str(output), "summary": result.summary.as_dict(), "settings": result.settings.as_dict()}


def sentences(output: Path, result: "Result") -> list[str]:
    """What a person wants to know of the result."""
    summary = result.summary
    closed = "watertight" if summary.watertight else "NOT watertight"
    genus = "unknown" if summary.genus is None else str(summary.genus)
    crossing = f"; {summary.self_intersecting:,} pass through others" if summary.self_intersecting else ""
    return [
        f"Wrote {output}: {summary.faces:,} triangles, {closed}, "
        f"{summary.components} component{'s' if summary.components != 1 else ''}, genus {genus}{crossing}.",
        f"Points to mesh: mean {summary.distance_mean:.4g}, 95 % within {summary.distance_p95:.4g}, "
        f"farthest {summary.distance_max:.4g} (diagonal {summary.diagonal:.4g}), in the cloud's unit.",
        "Seconds: " + ", ".join(f"{name} {seconds:.1f}" for name, seconds in summary.seconds.items()) + ".",
    ]


def command(arguments: argparse.Namespace, *more: object) -> str:
    """The command that makes the same fit, with more options, for a shell."""
    words = ("weingarten", "fit", arguments.cloud, "-o", arguments.output, *more, *repeated(arguments))
    return shlex.join(map(str, words))


def repeated(arguments: argparse.Namespace) -> list[str]:
    """The options that make another fit the same fit."""
    names = (
        "preset",
        "method",
        "schedule",
        "knots",
        "term",
        "stencil",
        "steps",
        "rate",
        "points_per_step",
        "resolution",
        "sharp",
        "trim_distance",
        "simplify",
        "seed",
        "oracle",
        "device",
    )
    given = {name: getattr(arguments, name) for name in names}
    given = {name: value for name, value in given.items() if value not in (None, "standard", 0, "auto")}
    return [word for name, value in given.items() for word in (f"--{name.replace('_', '-')}", str(value))]
