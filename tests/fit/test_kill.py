"""A fit killed at any operation on a file leaves a folder with one fit or none, and a whole output."""

import json
import os
import subprocess
import sys
from pathlib import Path


def test_killed_at_every_state_of_its_files_and_gone_on_with(tmp_path):
    """By signal 9, in a fit begun over an earlier one and in a resumed one: see killed.py."""
    program = Path(__file__).parent / "killed.py"
    words = [sys.executable, str(program), str(tmp_path)]
    # it forks, and a copy of a process has none of the threads of OpenMP that it may wait for
    alone = {**os.environ, "OMP_NUM_THREADS": "1"}
    said = subprocess.run(words, capture_output=True, text=True, timeout=300, env=alone)
    assert said.returncode == 0, said.stderr
    for found in json.loads(said.stdout).values():
        assert found["wrong"] == {}
        assert found["operations"] > 40
        assert found["kills"] > 15
        assert found["states"] > 8
