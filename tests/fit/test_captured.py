"""A step as one piece of work with its numbers on the device is the plain loop's step, to the bit.

What records and replays it needs a GPU; here the work replays itself.
"""

import contextlib
import dataclasses
from types import SimpleNamespace

import pytest
import torch

from weingarten.fields.ensemble import Ensemble
from weingarten.fields.siren import Siren
from weingarten.fit.captured import READ_EVERY, Captured, recorder
from weingarten.fit.loop import Loop, run
from weingarten.fit.optimisers import adam, cosine, muon
from weingarten.methods import METHODS
from weingarten.oracle import EVERY
from weingarten.scan.generators import Generators
from weingarten.scan.interleaved import Interleaved
from weingarten.scan.sample import DOMAINS, OFF_SURFACE, Sample

SMALL = {"width": 16, "depth": 3, "points": 50, "steps": 60, "ramp": (0.4, 1.6)}
SMALL |= {"rate": cosine, "base_rate": 5e-4}
SINES = [name for name, method in METHODS.items() if method.field is Siren]
"""Other fields' steps are not recorded."""

WHOLE = SMALL | {"steps": 40}
"""Of a fit that is compared with another from its first step to its last: one whole stride and a part."""

HOW = ((adam, True), (muon, False))
"""By turns; one method has all."""


def captured(loop, replay=lambda work: work):
    """The same loop with its steps as pieces of work."""
    own = {field.name: getattr(loop, field.name) for field in dataclasses.fields(Loop) if field.init}
    return Captured(**own, replay=replay)


def taken(loop):
    records = []
    assert run(loop, lambda record, _: records.append(record))
    return records


def assert_same_fit(plain, other):
    expected, found = taken(plain), taken(other)
    assert [dataclasses.asdict(record) | {"terms": None} for record in found] == [
        dataclasses.asdict(record) | {"terms": None} for record in expected
    ]
    for one, another in zip(found, expected, strict=True):
        assert one.terms == pytest.approx(another.terms, rel=0, abs=0, nan_ok=True)
    for one, another in zip(other.field.parameters(), plain.field.parameters(), strict=True):
        assert torch.equal(one, another)


@pytest.mark.parametrize(
    ("method", "builder", "double"),
    [(method, *HOW[i % len(HOW)]) for i, method in enumerate(SINES) if method != "odw"]
    + [("odw", builder, double) for builder in (adam, muon) for double in (True, False)],
)
def test_the_fit_is_that_of_the_plain_loop_to_the_bit(make_loop, signed_draws, method, builder, double):
    loops = []
    for _ in range(2):
        loop = make_loop(METHODS[method], draws=signed_draws, double=double, **WHOLE)
        loop.optimisers = builder(loop.field)
        loops.append(loop)
    assert_same_fit(loops[0], captured(loops[1]))


def test_an_ensembles_fit_is_that_of_the_plain_loop_to_the_bit(make_loop, signed_draws):
    loops = []
    for _ in range(2):
        loop = make_loop(METHODS["odw"], draws=Interleaved([signed_draws] * 2), **WHOLE)
        sirens = [Siren(16, 3, generator=torch.Generator().manual_seed(i)) for i in range(2)]
        loop.field = Ensemble.of(sirens)
        loop.generator = Generators([torch.Generator().manual_seed(i) for i in range(2)])
        loop.optimisers = muon(loop.field)
        loop.__post_init__()
        loops.append(loop)
    assert_same_fit(loops[0], captured(loops[1]))


def test_one_piece_of_work_for_each_outline(make_loop, signed_draws):
    made = []
    loop = make_loop(METHODS["odw"], draws=signed_draws, **SMALL)
    other = captured(loop, lambda work: (made.append(work), work)[1])
    taken(other)
    outlines = {loop.outline(step / 60) for step in range(60)}
    assert 6 < len(outlines) < 9
    assert len(made) == len(outlines)


def test_a_stride_ends_at_a_reading_and_misses_no_step(make_loop):
    loop = captured(make_loop(METHODS["odw-paper"], **SMALL))
    loop.step = 3
    lengths = []
    while loop.step < loop.steps:
        records = loop.stride()
        lengths.append(len(records))
        assert records[-1].step == loop.step - 1
    assert lengths == [READ_EVERY - 3, READ_EVERY, 60 - 2 * READ_EVERY]


def test_the_oracle_sees_the_steps_that_it_asks_for():
    assert EVERY % READ_EVERY == 0


@pytest.mark.parametrize(
    ("method", "builder", "members"),
    [(method, *((adam, None), (muon, 3))[i % 2]) for i, method in enumerate(SINES)],
)
def test_no_step_asks_the_device_for_a_value(make_loop, method, builder, members):
    """On the meta device there is none: whatever needs one raises."""
    loop = make_loop(METHODS[method], **SMALL)
    if members:
        loop.field = Ensemble.of([loop.field] * members)
    loop.field = loop.field.to("meta")
    loop.optimisers = builder(loop.field)

    def draws(count, generator):
        shape = (count, members) if members else (count,)
        points, numbers = torch.empty(*shape, 3, device="meta"), torch.empty(shape, device="meta")
        return {name: Sample(points, numbers if name == OFF_SURFACE else None, numbers) for name in DOMAINS}

    loop.draws = draws
    loop.__post_init__()
    other = captured(loop)
    outlines = {loop.outline(step / 60) for step in range(60)}
    for outline in outlines:
        sums = other.replayed(outline)()
        assert sums.is_meta
        assert sums.shape == (len(METHODS[method].terms), *([members] if members else []))
    with pytest.raises(RuntimeError):
        loop.stride()


class FakeGraph:
    """Notes what is asked of a CUDA graph."""

    def __init__(self, log):
        self.log = log

    def register_generator_state(self, generator):
        self.log.append("register")

    def replay(self):
        self.log.append("replay")


def test_a_graph_is_rehearsed_then_recorded_then_replayed(monkeypatch):
    """Without a GPU only the order of what is asked of torch can be seen."""
    log = []

    @contextlib.contextmanager
    def recording(graph, pool):
        log.append(f"record into {pool}")
        yield
        log.append("recorded")

    stream = SimpleNamespace(wait_stream=lambda other: log.append("wait"))
    monkeypatch.setattr(torch.cuda, "CUDAGraph", lambda: FakeGraph(log))
    monkeypatch.setattr(torch.cuda, "graph", recording)
    monkeypatch.setattr(torch.cuda, "Stream", lambda: stream)
    monkeypatch.setattr(torch.cuda, "current_stream", lambda: stream)
    monkeypatch.setattr(torch.cuda, "stream", lambda _: contextlib.nullcontext())
    monkeypatch.setattr(torch.cuda, "graph_pool_handle", lambda: "pool")
    output = torch.ones(2)
    generators = Generators([torch.Generator(), torch.Generator()])
    graph = recorder(generators)(lambda: (log.append("work"), output)[1])
    assert graph() is output
    assert log == ["wait", "work", "wait"]
    log.clear()
    assert graph() is output
    assert log == ["register", "register", "record into pool", "work", "recorded", "replay"]
    log.clear()
    assert graph() is output
    assert log == ["replay"]
    assert len(recorder(torch.Generator())(lambda: output).generators) == 1
