"""Pieces of a step: every point once, no piece too large, a fair share for every one of the crew."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from weingarten.calculus.jet import GRADIENT, TANGENT, VALUE
from weingarten.fit.pieces import LEAST, PASSES, Part, cost, cut
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
        assert 0 < sum(len(p.sample) for p in piece) <= chunk
        assert len({p.order for p in piece}) == 1
        for p in piece:
            assert torch.equal(p.sample.points[:, 0], p.sample.angles)
            seen += [(mark, p.order) for mark in p.sample.angles.tolist()]
    expected = [(mark, p.order) for p in parts for mark in p.sample.angles.tolist()]
    assert sorted(seen) == sorted(expected)


@pytest.mark.parametrize("crew", [1, 2, 3])
def test_what_is_worth_it_is_shared_evenly(crew):
    pieces = cut(parts_of([(1500, GRADIENT), (1500, GRADIENT), (3000, VALUE)]), crew, 100_000)
    assert len(pieces) == 2 * crew
    for order in (GRADIENT, VALUE):
        sizes = [sum(len(p.sample) for p in piece) for piece in pieces if piece[0].order == order]
        assert max(sizes) - min(sizes) <= 1


def test_a_handful_of_points_stays_together():
    count = LEAST // PASSES[TANGENT] - 1
    assert len(cut(parts_of([(count, TANGENT)]), 2, 2048)) == 1


def test_the_dearest_piece_comes_first():
    costs = [cost(piece) for piece in cut(parts_of([(300, VALUE), (300, TANGENT), (300, GRADIENT)]), 1, 100)]
    assert costs == sorted(costs, reverse=True)
    assert sum(costs) == 300 * (3 + 6 + 12)


def test_no_piece_is_empty_where_the_crew_does_not_divide_the_points():
    assert len(cut(parts_of([(2100, TANGENT)]), 8, 1)) == 2100
