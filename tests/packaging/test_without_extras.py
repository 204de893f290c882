"""Without the extras everything is imported and every verb explains itself; `doctor` knows all extras."""

import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from extras import DEVELOPING, MODULES, PROJECT, ROOT, environment

from weingarten.cli.doctor import EXTRAS

PROGRAM = """
import sys
from importlib.util import find_spec
import weingarten
from weingarten.cli.doctor import EXTRAS, installed
from weingarten.cli.main import VERBS, main
assert not any(map(installed, EXTRAS))
assert not any(map(find_spec, sys.argv[1].split(",")))
for name in weingarten.__all__:
    getattr(weingarten, name)
for verb in VERBS:
    try:
        main([verb.__name__.rpartition(".")[2], "--help"])
    except SystemExit as end:
        assert end.code == 0, verb
assert not set(sys.argv[1].split(",")) & set(sys.modules)
"""


def test_all_names_and_every_verbs_help() -> None:
    words = [sys.executable, "-c", PROGRAM, ",".join(MODULES)]
    done = subprocess.run(words, env=environment(ROOT / "src"), capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


def test_doctor_knows_every_extra_of_a_user() -> None:
    assert set(EXTRAS) == set(PROJECT["optional-dependencies"]) - DEVELOPING
