"""Many clouds in, as many meshes out: their fields are fitted together, as one ensemble."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TypeVar, cast

import numpy as np
from jaxtyping import Float64

from weingarten.crew import THREADS
from weingarten.device import chosen_device
from weingarten.errors import FitError, OptionError, WeingartenError
from weingarten.fields.ensemble import Ensemble
from weingarten.fields.siren import Siren
from weingarten.fit.loop import Loop, Record, run
from weingarten.observer import Observer
from weingarten.reconstruction import Clock, Ending, Result, check_finite, concluded
from weingarten.scan.generators import Generators
from weingarten.scan.interleaved import Interleaved
from weingarten.schedules.weight import Adapted
from weingarten.settings import Settings, resolve
from weingarten.start import Start, loop_of
from weingarten.surface.decimation import required

Points = Float64[np.ndarray, "_ 3"]
Answer = TypeVar("Answer")
Errors = dict[int, WeingartenError]


def reconstruct_many(
    clouds: Sequence[Points],
    settings: Settings | None = None,
    *,
    device: str = "auto",
    observer: Observer | None = None,
) -> list[Result | WeingartenError]:
    """Fit a signed distance field to each of many unoriented clouds, all at once, and extract their surfaces.

    Every part gets what `weingarten.reconstruct` would give it, up to rounding: draws, gradient, clipping and
    optimiser are its own. The seconds of its fit are those of all the fits together.

    clouds, device, observer: as in `weingarten.reconstruct`. settings: the same for all, the seed as well.

    The answers are in the order of the clouds. Where a cloud holds no part, a fit's loss is not finite or a
    field has no surface, the CloudError, FitError or ExtractionError that says so is the answer, and the
    others go on. Raises DeviceError, MissingExtraError as `weingarten.reconstruct`, and OptionError for a
    method whose fields cannot be laid side by side or whose weights follow one fit.
    """
    settings, observer, target = settings or resolve(), observer or Observer(), chosen_device(device)
    check_joint(settings)
    if settings.simplify > 0.0:
        required()
    THREADS.join()
    clocks = [Clock(observer) for _ in clouds]
    errors: Errors = {}

    def started(index: int) -> Start:
        clocks[index].phase("preparing")
        start = Start.of(clouds[index], settings, target)
        clocks[index].phase("")
        for note in start.notes:
            observer.note(note)
        return start

    starts = attempted(started, range(len(clouds)), errors)
    if not starts:
        return list(errors.values())
    outcomes: dict[int, Result] = {}
    for pace in sorted({start.draws.pace for start in starts.values()}, reverse=True):
        alike = {index: start for index, start in starts.items() if start.draws.pace == pace}
        outcomes |= fitted(settings, alike, clocks, Numbered(observer, list(starts), list(alike)), errors)
    return [(outcomes | errors)[index] for index in range(len(clouds))]


class Numbered(Observer):
    """Tells an observer of steps by the number that a part has among all, not among those fitted now."""

    def __init__(self, observer: Observer, every: list[int], now: list[int]) -> None:
        self.observer, self.numbers = observer, [every.index(task) for task in now]

    def phase(self, name: str) -> None:
        """See Observer."""
        self.observer.phase(name)

    def step(self, record: Record, steps: int, seconds: float) -> None:
        """See Observer."""
        self.observer.step(replace(record, member=self.numbers[record.member]), steps, seconds)

    def interrupted(self) -> bool:
        """See Observer."""
        return self.observer.interrupted()


def fitted(
    settings: Settings, starts: dict[int, Start], clocks: list[Clock], observer: Observer, errors: Errors
) -> dict[int, Result]:
    """The parts of one pace, as one ensemble."""
    loop = joint(settings, list(starts.values()))
    clock = Clock(observer)
    clock.phase("fitting")
    endings = fit_all(loop, list(starts), observer, errors)
    clock.phase("")

    def ended(index: int) -> Result:
        field = cast(Ensemble, loop.field).member(list(starts).index(index))
        clocks[index].seconds |= clock.seconds
        return concluded(starts[index], field, endings[index], clocks[index], loop.crew)

    return attempted(ended, endings, errors)


def check_joint(settings: Settings) -> None:
    """Raise OptionError where parts have to be fitted one by one."""
    method = settings.resolved_method()
    if method.field is not Siren:
        raise OptionError(
            f"Method {method.name} fits no SIREN; fit the parts one by one, without --together."
        )
    if any(isinstance(weight, Adapted) for weight in method.terms.values()):
        raise OptionError(
            "An adaptive weight follows a single fit; fit the parts one by one, without --together."
        )


def attempted(work: Callable[[int], Answer], tasks: Iterable[int], errors: Errors) -> dict[int, Answer]:
    """What becomes of each task; what cannot be done is noted in `errors`, and the next task begins."""
    answers: dict[int, Answer] = {}
    for task in tasks:
        try:
            answers[task] = work(task)
        except WeingartenError as error:
            errors[task] = error.with_traceback(None)
    return answers


def joint(settings: Settings, starts: Sequence[Start]) -> Loop:
    """One loop that fits them all."""
    ensemble = Ensemble.of([cast(Siren, start.field) for start in starts])
    draws = Interleaved([start.draws for start in starts])
    generators = Generators([start.generator for start in starts])
    return loop_of(settings, ensemble, draws, generators, pace=starts[0].draws.pace)


def fit_all(loop: Loop, tasks: Sequence[int], observer: Observer, errors: Errors) -> dict[int, Ending]:
    """Step to the end, or until every part is lost; how each fit ended that was not. Member i is tasks[i]."""
    losses: dict[int, float] = {}

    def each(record: Record, seconds: float) -> None:
        task = tasks[record.member]
        try:
            check_finite(record)
        except FitError as error:
            errors.setdefault(task, error.with_traceback(None))
        losses[task] = record.loss
        observer.step(record, loop.steps, seconds)

    finished = run(loop, each, lambda: observer.interrupted() or errors.keys() >= set(tasks))
    return {task: Ending(loop.step, finished, losses.get(task)) for task in tasks if task not in errors}
