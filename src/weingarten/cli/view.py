"""`weingarten view`: a run, a mesh or a cloud in the browser."""

import argparse
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from weingarten.cli.importing import importing
from weingarten.cli.mesh_source import bundled_name, load
from weingarten.errors import InputError, OptionError, OutputError

if TYPE_CHECKING:
    from weingarten.view.server import Server
    from weingarten.view.subject import Subject

HOST = "127.0.0.1"
FORMATS = (".html", ".htm")
EXAMPLE = """\
examples:
  weingarten view part.run                  while the fit runs, or afterwards
  weingarten view part.stl --points scan.ply
  weingarten view part.run -o part.html     one file that needs no server

The page is served on this machine alone, until Ctrl-C."""


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "view",
        help="look at a run, a mesh or a cloud in the browser",
        description="Show a run, a mesh or a cloud in the browser: 3D, colours, cross-sections, steps.",
        formatter_class=formatter,
        epilog=EXAMPLE,
    )
    verb.add_argument("source", metavar="RUN|MESH|CLOUD", help="run folder, mesh or cloud, or bundled:flange")
    verb.add_argument("--points", metavar="CLOUD", type=Path, help="points to show with a mesh")
    verb.add_argument("-o", "--output", metavar="PAGE", type=Path, help="write a page instead of serving one")
    verb.add_argument("--host", default=HOST, metavar="NAME", help="address to listen at")
    verb.add_argument("--port", type=int, default=0, metavar="N", help="port to listen at; 0: any free one")
    verb.add_argument("--open", action="store_true", help="open the page in a browser")
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Serve until Ctrl-C, or write. Raises a WeingartenError that names the option or file at fault."""
    if not 0 <= arguments.port <= 65535:
        raise OptionError(f"--port must be between 0 and 65,535; got {arguments.port:,}.")
    output = arguments.output
    if output is not None and output.suffix.lower() not in FORMATS:
        raise OutputError(f"{output} is to be a page; end its name in .html.")
    with importing():
        from weingarten.view.display import TRIANGLES
        from weingarten.view.exhibit import Exhibit
        from weingarten.view.page import write_page
        from weingarten.view.server import Server

    exhibit = Exhibit(subject(arguments.source, arguments.points), TRIANGLES)
    if output is not None:
        size = write_page(exhibit, output)
        sys.stdout.write(f"Wrote {output}: {size / 1e6:.1f} MB.\n")
        return 0
    with Server(exhibit, arguments.host, arguments.port) as server:
        sys.stdout.write("\n".join(invitation(server, os.environ)) + "\n")
        sys.stdout.flush()
        serve(server, arguments.open)
    return 0


def subject(source: str, points: Path | None) -> "Subject":
    """What the command line names. Raises InputError, CheckpointError."""
    from weingarten.view.run import Run
    from weingarten.view.subject import Cloud, Still, still

    name = bundled_name(source)
    if name is not None:
        return Still(name, load(source), None if points is None else Cloud.read(points))
    path = Path(source)
    if not path.is_dir():
        return still(path, points)
    if points is not None:
        raise InputError(f"{path} is a run folder, which has its own points; leave --points out.")
    if not (path / "checkpoint.safetensors").is_file():
        raise InputError(
            f"{path} is no run folder, for it holds no checkpoint; `weingarten fit --run` makes one."
        )
    return Run(path)


def invitation(server: "Server", environment: Mapping[str, str]) -> list[str]:
    """Where the page is, and over SSH how to reach it."""
    said = [f"{server.address}   (Ctrl-C ends it)"]
    connection = environment.get("SSH_CONNECTION", "").split()
    if server.host == HOST and len(connection) == 4:
        port, user = server.server_port, environment.get("USER", "")
        to = f"{user}@{connection[2]}" if user else connection[2]
        said.append(
            f"From your own machine:  ssh -L {port}:127.0.0.1:{port} {to}   then open the address there"
        )
    if server.host not in (HOST, "localhost", "::1"):
        said.append(f"Whoever reaches {server.host} can see this part.")
    return said


def serve(server: "Server", opens: bool) -> None:
    """Until Ctrl-C."""
    if opens:
        import webbrowser

        webbrowser.open(server.address)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        sys.stdout.write("\n")
