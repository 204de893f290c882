"""Several cores at once: every job on one core, instead of every operation on all of them.

A network of width 256 has operations of some tens of microseconds; spreading each over the cores costs as
much again, and a core's cache never holds a whole array. Threads share the interpreter, and wait for it after
every small operation, so a job should be large, and let go of the interpreter while it computes.
"""

import functools
from collections import deque
from collections.abc import Callable, Sequence
from threading import Condition, Lock, Thread
from typing import TypeVar

import torch

Task = TypeVar("Task")
Answer = TypeVar("Answer")
Job = Callable[[], object]


class Threads:
    """How many threads torch takes for an operation, in a process where several crews may be at work.

    Torch keeps a number for every thread, which takes the process's with its first operation; to set a
    thread's is to set the process's as well. A thread that begins while another one's crew is at work would
    take that crew's single thread for the process's choice, and make its own crew, and its sums, otherwise.
    """

    def __init__(self) -> None:
        self.lock = Lock()
        self.crews = 0
        self.outside = 1

    def join(self) -> None:
        """Have the calling thread begin with the number that the process has outside of all crews."""
        with self.lock:
            if self.crews > 0:
                torch.set_num_threads(self.outside)

    def single(self) -> int:
        """One for the calling thread from here on; the number that `again` is to be given."""
        with self.lock:
            before = torch.get_num_threads()
            if self.crews == 0:
                self.outside = before
            self.crews += 1
            torch.set_num_threads(1)
        return before

    def again(self, before: int) -> None:
        """The number that the calling thread had."""
        with self.lock:
            self.crews -= 1
            torch.set_num_threads(before)


THREADS = Threads()
"""Of the process, as torch's own number is."""


class Crew:
    """So many threads, of which the calling one is the first; the others live within `with crew:`.

    There, torch's operations are each on one core, in the calling thread too: torch's own threads stay awake
    for a while after an operation and would take the cores. A crew of one, for devices that are parallel by
    themselves, does everything in the calling thread when it comes to `finish`.

    desk: to be held by a job while it does many small operations. Two threads that did these side by side
    would hand the interpreter to each other after every one, which takes longer than the operation.
    """

    def __init__(self, size: int = 1) -> None:
        self.size = size
        self.before: list[int] = []
        self.others: list[Thread] = []
        self.jobs: deque[Job] = deque()
        self.open = 0
        self.error: BaseException | None = None
        self.changed = Condition()
        self.desk = Lock()

    def __enter__(self) -> None:
        """Have the others come; within another `with` of the same crew they are there."""
        self.before.append(THREADS.single() if self.size > 1 else torch.get_num_threads())
        if len(self.before) == 1:
            self.others = [Thread(target=self._help, daemon=True) for _ in range(self.size - 1)]
            for thread in self.others:
                thread.start()

    def __exit__(self, *_: object) -> None:
        """Have them go, whatever happened."""
        threads = self.before.pop()
        if not self.before:
            with self.changed:
                self.changed.notify_all()
            for thread in self.others:
                thread.join()
            # what an error outside of all jobs left behind is not the next one's
            self.jobs.clear()
            self.open, self.error = 0, None
        if self.size > 1:
            THREADS.again(threads)

    def begin(self, job: Job) -> None:
        """Have a job done by whoever is free next; it may begin others."""
        with self.changed:
            self.open += 1
            self.jobs.append(job)
            self.changed.notify()

    def finish(self) -> None:
        """Work until all that was begun is done, and raise the first error of any.

        An error drops what waits then; jobs that run may still begin others. Not to be called in a job.
        """
        while self._work(lambda: self.open > 0):
            pass
        error, self.error = self.error, None
        try:
            if error is not None:
                raise error
        finally:
            del error  # or its traceback would keep this frame, and this frame the traceback

    def map(self, work: Callable[[Task], Answer], tasks: Sequence[Task]) -> list[Answer]:
        """[work(task) for task in tasks], with gradients on or off as in the calling thread.

        What is computed does not depend on the number of threads.
        """
        grad, answers = torch.is_grad_enabled(), dict[int, Answer]()
        for index, task in enumerate(tasks):
            self.begin(functools.partial(answer, work, task, index, answers, grad))
        self.finish()
        return [answers[index] for index in range(len(tasks))]

    def _help(self) -> None:
        """What the others do."""
        torch.set_num_threads(1)
        while self._work(lambda: bool(self.before)):
            pass

    def _work(self, stays: Callable[[], bool]) -> bool:
        """Do the next job, waiting for one while `stays()`. False if there was none."""
        with self.changed:
            while not self.jobs:
                if not stays():
                    return False
                self.changed.wait()
            job = self.jobs.popleft()
        try:
            job()
        except BaseException as error:
            self._give_up(error)
        with self.changed:
            self.open -= 1
            if self.open == 0:
                self.changed.notify_all()
        return True

    def _give_up(self, error: BaseException) -> None:
        """Keep the first error; drop what waits."""
        with self.changed:
            self.error = self.error or error
            self.open -= len(self.jobs)
            self.jobs.clear()


def crew_for(device: torch.device) -> Crew:
    """A thread a core on a CPU, as many as torch may use; elsewhere the calling thread."""
    return Crew(torch.get_num_threads() if device.type == "cpu" else 1)


def answer(
    work: Callable[[Task], Answer], task: Task, index: int, answers: dict[int, Answer], grad: bool
) -> None:
    """Note work(task) under its index, with gradients on or off."""
    with torch.set_grad_enabled(grad):
        answers[index] = work(task)
