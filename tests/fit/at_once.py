"""Four fits at once, in threads and in processes, and the same one after another: hashes of their meshes.

Run by itself with OMP_NUM_THREADS=2: `python at_once.py`. Processes are forked before anything is computed.
"""

import hashlib
import json
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import torch

sys.path.insert(0, str(Path(__file__).parent))
from small import small_cloud, small_settings

from weingarten.reconstruction import reconstruct

SEEDS = range(4)


def fitted(seed: int) -> str:
    """The hash of a mesh. Every fit is of another cloud."""
    mesh = reconstruct(small_cloud(seed), small_settings(6, seed)).mesh
    return hashlib.sha256(mesh.vertices.tobytes() + mesh.faces.tobytes()).hexdigest()


def in_processes() -> list[str]:
    """Each in a process of its own, all at once."""
    pipes = [os.pipe() for _ in SEEDS]
    for seed, (_, writing) in zip(SEEDS, pipes, strict=True):
        if os.fork() == 0:
            os.write(writing, fitted(seed).encode())
            os._exit(0)
        os.close(writing)
    hashes = []
    for reading, _ in pipes:
        with os.fdopen(reading) as stream:
            hashes.append(stream.read())
    return hashes


def main() -> None:
    """Processes first: a process that has computed with threads cannot be forked."""
    processes = in_processes()
    alone = [fitted(seed) for seed in SEEDS]
    with ThreadPoolExecutor(len(SEEDS)) as pool:
        threads = list(pool.map(fitted, SEEDS))
    found = {"alone": alone, "processes": processes, "threads": threads}
    json.dump(found | {"number": torch.get_num_threads()}, sys.stdout)
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
