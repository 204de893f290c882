"""`weingarten doctor`: what this machine has, what is missing, and what each preset would cost here."""

import argparse
import json
import sys
from importlib.metadata import PackageNotFoundError, requires, version
from importlib.util import find_spec
from platform import platform, python_version

EXTRAS = {
    "3mf": ("lxml", "networkx"),
    "bench": ("gpytoolbox",),
    "ray": ("ray",),
    "report": ("jinja2", "matplotlib", "fast_simplification"),
    "simplify": ("fast_simplification",),
}
"""Optional parts and the modules they need."""


def add(verbs, formatter: type[argparse.HelpFormatter]) -> None:
    """Add the verb to the subparsers."""
    verb = verbs.add_parser(
        "doctor",
        help="what this machine has, and what each preset costs on it",
        description="Versions, device, threads, missing optional parts, and an estimate for each preset.",
        formatter_class=formatter,
    )
    verb.add_argument("--device", default="auto", metavar="NAME", help="auto, cpu, cuda or mps")
    verb.add_argument(
        "--json",
        action="store_true",
        help="one JSON object on the standard output",
    )
    verb.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Examine and print."""
    import torch

    from weingarten.calculus.kernels import LANES
    from weingarten.cli.memory import keep_freed_memory
    from weingarten.device import chosen_device

    keep_freed_memory()
    device = chosen_device(arguments.device)
    name = torch.cuda.get_device_name(device) if device.type == "cuda" else device.type
    found = {
        "platform": platform(),
        "python": python_version(),
        "versions": versions(),
        "device": name,
        "threads": torch.get_num_threads(),
        "lanes": LANES,
        "missing": {extra: f'pip install "weingarten[{extra}]"' for extra in EXTRAS if not installed(extra)},
        "presets": costs(device),
    }
    sys.stdout.write((json.dumps(found) if arguments.json else "\n".join(lines(found))) + "\n")
    return 0


def versions() -> dict[str, str]:
    """weingarten's version and those of what it stands on."""
    found = {"weingarten": version("weingarten")}
    for requirement in requires("weingarten") or []:
        if "extra ==" in requirement:
            continue
        package = requirement.split(">")[0].split("=")[0].strip()
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "MISSING"
    return found


def installed(extra: str) -> bool:
    """Whether every module of an extra is there."""
    return all(find_spec(module) is not None for module in EXTRAS[extra])


def costs(device) -> dict[str, dict[str, float]]:
    """Estimated seconds and gigabytes of each preset, on a cloud of a bundled part, by trial steps."""
    from weingarten.fit.estimate import estimate
    from weingarten.reconstruction import prepared
    from weingarten.samples.parts import sample_part
    from weingarten.settings import PRESETS, resolve

    points = sample_part("flange", 10_000, 0)
    found = {}
    for name in PRESETS:
        settings = resolve(preset=name)
        cost = estimate(prepared(points, settings, device), settings.resolution)
        found[name] = {
            "seconds": round(cost.total, 1),
            "step_seconds": round(cost.step, 4),
            "gigabytes": round(cost.memory / 2**30, 2),
        }
    return found


def lines(found: dict) -> list[str]:
    """The findings for a person."""
    from weingarten.duration import duration

    shown = [f"{key}: {found[key]}" for key in ("platform", "python", "device", "threads", "lanes")]
    shown += [f"{package} {number}" for package, number in found["versions"].items()]
    shown += [f"missing: {extra} ({command})" for extra, command in found["missing"].items()]
    shown += [
        f"preset {name}: about {duration(cost['seconds'])}, {cost['gigabytes']:.1f} GB"
        for name, cost in found["presets"].items()
    ]
    return shown
