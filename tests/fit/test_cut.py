"""Pieces of a step: every point once, no piece too large, a fair share for every one of the crew."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from weingarten.calculus.jet import GRADIENT, TANGENT, VALUE, Jet
from weingarten.crew import Crew
from weingarten.fit.pieces import LEAST, PASSES, WHOLE, Part, Piece, cost, cut, through
from weingarten.scan.sample import Sample
from weingarten.terms.dirichlet import DIRICHLET


def part(first, count, order):
    marks = torch.arange(first, first + count, dtype=torch.float64)
    return Part(Sample(marks.unsqueeze(-1).expand(-1, 3), angles=marks), order, (DIRICHLET,))


def parts_of(counts_and_orders):
    first, found = 0, []
    for count, order in counts_and_orders:
        found.append(part(first, count, order))
        first += count
    return found


PARTS = st.lists(st.tuples(st.integers(1, 900), st.sampled_from([VALUE, GRADIENT, TANGENT])), max_size=6)


@given(PARTS, st.integers(1, 8), st.integers(1, 500))
def test_every_point_is_in_one_piece_with_its_angle_and_order(rows, crew, chunk):
    parts = parts_of(rows)
    seen = []
    for piece in cut(parts, crew, chunk):
        assert 0 < sum(len(p.sample) for p in piece) <= chunk * crew
        assert len({p.order for p in piece}) == 1
        for p in piece:
            assert torch.equal(p.sample.points[:, 0], p.sample.angles)
            seen += [(mark, p.order) for mark in p.sample.angles.tolist()]
    expected = [(mark, p.order) for p in parts for mark in p.sample.angles.tolist()]
    assert sorted(seen) == sorted(expected)


class Noted:
    """An evaluation that does nothing but say that it was there."""

    def __init__(self, points, order, angles):
        self.points, self.order = points, order

    def forward(self):
        self.there = True

    def jet(self):
        return Jet(self.points[:, 0])

    def pull(self, bars):
        (self.bar,) = bars

    def backward(self):
        assert self.there

    def gradient(self):
        return self.bar.sum().view(1)


def legs_of(parts, crew):
    made = []
    piece = Piece(parts, lambda *leg: (made.append(Noted(*leg)), made[-1])[1], {DIRICHLET: 2.0}, Crew(crew))
    through(piece.crew, [piece], 1)
    return piece, made


@pytest.mark.parametrize("crew", [1, 2, 3])
def test_what_is_worth_it_is_shared_evenly(crew):
    (piece,) = cut(parts_of([(1500, GRADIENT), (1500, GRADIENT)]), crew, 100_000)
    piece, legs = legs_of(piece, crew)
    assert len(legs) == crew
    sizes = [len(leg.points) for leg in legs]
    assert all(size % WHOLE == 0 for size in sizes[:-1])
    assert sum(sizes) == 3000
    assert max(sizes) - min(sizes) <= crew * WHOLE
    assert float(piece.totals[DIRICHLET]) == sum(range(3000))
    assert float(piece.gradient) == 2.0 * 2999


def test_a_handful_of_points_stays_together():
    count = LEAST // PASSES[TANGENT] - 1
    (piece,) = cut(parts_of([(count, TANGENT)]), 2, 2048)
    assert len(legs_of(piece, 2)[1]) == 1


def test_the_highest_order_comes_first_and_no_more_pieces_than_wanted_are_on_their_way():
    pieces = cut(parts_of([(300, VALUE), (300, TANGENT), (300, GRADIENT)]), 1, 100)
    assert [piece[0].order for piece in pieces] == [TANGENT] * 3 + [GRADIENT] * 3 + [VALUE] * 3
    assert sum(cost(piece) for piece in pieces) == 300 * (3 + 6 + 12)
    begun, done, crew = [], [], Crew(1)

    def begin(*leg):
        begun.append(leg)
        assert len(begun) - len(done) <= 2
        return Noted(*leg)

    class Counted(Piece):
        def gather(self):
            done.append(self)
            super().gather()

    through(crew, [Counted(piece, begin, {DIRICHLET: 1.0}, crew) for piece in pieces], 2)
    assert len(begun) == len(done) == 9


def test_no_piece_is_empty_where_the_crew_does_not_divide_the_points():
    sizes = [sum(len(p.sample) for p in piece) for piece in cut(parts_of([(2100, TANGENT)]), 8, 1)]
    assert sum(sizes) == 2100
    assert set(sizes) == {7, 8}
