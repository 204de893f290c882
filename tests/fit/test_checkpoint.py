"""A checkpoint brings a fresh loop to its own state, to the bit, or says why it cannot."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from weingarten.errors import CheckpointError
from weingarten.fit import checkpoint as checkpoints
from weingarten.fit.checkpoint import Origin, load, save
from weingarten.fit.loop import Loop
from weingarten.fit.optimisers import adam, muon, steady
from weingarten.frame import Frame
from weingarten.methods import METHODS
from weingarten.reconstruction import threads_notes
from weingarten.settings import resolve

SMALL = {"width": 16, "depth": 3, "points": 50, "steps": 10}


def fresh(make_loop):
    loop = make_loop(METHODS["odw-paper"], **SMALL)
    loop.optimisers = muon(loop.field)
    return loop


@pytest.fixture
def found(make_loop, tmp_path):
    """A checkpoint after four steps, and the loop that wrote it."""
    loop = fresh(make_loop)
    for _ in range(4):
        loop.advance()
    box = tuple(map(float, np.ones(3)))
    origin = Origin(resolve(), Frame((0.0, 0.0, 0.0), 1.0), "", box, box, 2.2)
    save(tmp_path / "checkpoint", loop, origin, {}, {})
    return load(tmp_path / "checkpoint"), loop


def test_a_restored_loop_goes_on_as_the_first_one_does(make_loop, found):
    checkpoint, loop = found
    other = fresh(make_loop)
    checkpoint.restore(other)
    assert [other.advance() for _ in range(3)] == [loop.advance() for _ in range(3)]
    for one, another in zip(other.field.parameters(), loop.field.parameters(), strict=True):
        assert torch.equal(one, another)


def test_a_checkpoint_of_another_kind_of_device_is_refused_before_anything_changes(make_loop, found):
    """A GPU's generator has a state of sixteen bytes."""
    checkpoint, _ = found
    state = {"generator": torch.zeros(16, dtype=torch.uint8)}
    other = fresh(make_loop)
    before = [weight.detach().clone() for weight in other.field.parameters()]
    with pytest.raises(CheckpointError, match="another kind of device"):
        replace(checkpoint, tensors=checkpoint.tensors | state).restore(other)
    assert all(torch.equal(one, two) for one, two in zip(before, other.field.parameters(), strict=True))


def test_a_checkpoint_of_another_format_is_refused(make_loop, tmp_path, monkeypatch):
    box = (1.0, 1.0, 1.0)
    origin = Origin(resolve(), Frame((0.0, 0.0, 0.0), 1.0), "", box, box, 2.2)
    monkeypatch.setattr(checkpoints, "FORMAT", "weingarten-2")
    save(tmp_path / "old", fresh(make_loop), origin, {}, {})
    monkeypatch.undo()
    with pytest.raises(CheckpointError, match="start the fit anew"):
        load(tmp_path / "old")


class Tied(torch.nn.Module):
    """Two names for one weight."""

    def __init__(self):
        super().__init__()
        self.first = torch.nn.Linear(3, 3)
        self.second = torch.nn.Linear(3, 3)
        self.second.weight = self.first.weight

    def forward(self, points):
        return self.second(torch.sin(self.first(points))).sum(dim=-1)


def test_layers_that_share_a_weight_come_back(make_loop, found, tmp_path):
    def loop_of(field):
        loop = make_loop(METHODS["odw-paper"], **SMALL)
        return Loop(field, loop.method, loop.draws, loop.generator, adam(field), steady, 5e-5, 10, 50, 10.0)

    ours = loop_of(Tied())
    ours.advance()
    save(tmp_path / "tied", ours, found[0].origin, {}, {})
    theirs = loop_of(Tied())
    load(tmp_path / "tied").restore(theirs)
    assert theirs.field.second.weight is theirs.field.first.weight
    torch.testing.assert_close(theirs.field.first.weight, ours.field.first.weight, rtol=0, atol=0)


def test_a_checkpoint_knows_how_many_threads_summed(found):
    assert found[0].threads == found[1].crew.size
    assert threads_notes(found[0].threads, found[1].crew.size) == threads_notes(0, 8) == ()
    assert "written with 2 threads, and this fit goes on with 8" in threads_notes(2, 8)[0]
