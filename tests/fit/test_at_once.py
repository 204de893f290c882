"""Fits that run side by side are those that run alone, to the bit, in threads as in processes."""

import json
import os
import subprocess
import sys
from pathlib import Path


def test_four_at_once():
    """With two torch threads, so that every fit has a crew; the process keeps its number of threads."""
    program = Path(__file__).parent / "at_once.py"
    environment = {**os.environ, "OMP_NUM_THREADS": "2"}
    words = [sys.executable, str(program)]
    said = subprocess.run(words, capture_output=True, text=True, timeout=600, env=environment)
    assert said.returncode == 0, said.stderr
    found = json.loads(said.stdout)
    assert len(set(found["alone"])) == 4
    assert found["processes"] == found["alone"]
    assert found["threads"] == found["alone"]
    assert found["number"] == 2
