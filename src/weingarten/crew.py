"""Several cores at once: every task on one core, instead of every operation on all of them.

A network of width 256 has operations of some tens of microseconds; spreading each over the cores costs as
much again, and a core's cache never holds a whole array. Threads share the interpreter, but torch and NumPy
let go of it while they compute.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import torch

Task = TypeVar("Task")
Answer = TypeVar("Answer")


class Crew:
    """Works through tasks in the calling thread, one after the other: for devices that are parallel."""

    size = 1

    def __enter__(self) -> None:
        """Begin the work."""

    def __exit__(self, *_: object) -> None:
        """End it, whatever happened."""

    def map(self, work: Callable[[Task], Answer], tasks: Sequence[Task]) -> list[Answer]:
        """[work(task) for task in tasks], with gradients on or off as in the calling thread."""
        return [work(task) for task in tasks]


class Threads(Crew):
    """A thread a core, each with torch's operations on that core alone.

    Within `with crew:` this also holds for the calling thread, whose own operations would otherwise wake
    torch's other threads; these stay awake for a while and take the cores. Answers keep the order of the
    tasks, so what is computed from the same tasks does not depend on the number of threads.
    """

    def __init__(self, size: int) -> None:
        self.size = size
        self.before: list[int] = []
        self.pool = ThreadPoolExecutor(size, "weingarten", initializer=torch.set_num_threads, initargs=(1,))

    def __enter__(self) -> None:
        self.before.append(torch.get_num_threads())
        torch.set_num_threads(1)

    def __exit__(self, *_: object) -> None:
        torch.set_num_threads(self.before.pop())

    def map(self, work: Callable[[Task], Answer], tasks: Sequence[Task]) -> list[Answer]:
        """See Crew; an exception of any task is raised here."""
        grad = torch.is_grad_enabled()

        def with_grad(task: Task) -> Answer:
            with torch.set_grad_enabled(grad):
                return work(task)

        return list(self.pool.map(with_grad, tasks))


def crew_for(device: torch.device) -> Crew:
    """Threads on a CPU, as many as torch may use; elsewhere the calling thread."""
    size = torch.get_num_threads() if device.type == "cpu" else 1
    return Threads(size) if size > 1 else Crew()
