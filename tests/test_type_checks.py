"""How often the types of a function's calls are checked while tests run."""

from itertools import pairwise

import jaxtyping
import pytest
from beartype import beartype
from jaxtyping import Float, TypeCheckError
from torch import Tensor, zeros

from type_checks import ALWAYS, EVERY, FIRST, checked_at_first
from weingarten.frame import Frame


def doubled(points: Float[Tensor, "n 3"]) -> Float[Tensor, "n 3"]:
    """A function with a wrong type to be called with."""
    return 2 * points


def test_first_calls_and_some_of_the_later_ones():
    checked = checked_at_first(doubled, typechecker=beartype)
    wrong = []
    for call in range(1, FIRST + 3 * EVERY):
        try:
            checked(zeros(4, 2))
        except TypeCheckError:
            wrong.append(call)
    assert wrong[:FIRST] == list(range(1, FIRST + 1))
    later = wrong[FIRST:]
    assert len(later) >= 2
    assert {following - call for call, following in pairwise(later)} == {EVERY}


@pytest.mark.parametrize("test", ["one", "another"])
def test_each_test_has_first_calls_of_its_own(test):
    checked = checked_at_first(doubled, typechecker=beartype)
    with pytest.raises(TypeCheckError):
        checked(zeros(4, 2))
    for _ in range(FIRST):
        checked(zeros(4, 3))
    checked(zeros(4, 2))


def test_functions_within_a_function_are_counted_together():
    def made():
        def inner(number: int) -> int:
            return number

        return checked_at_first(inner, typechecker=beartype)

    for _ in range(FIRST):
        made()(1)
    assert made()("text") == "text"


def test_the_package_is_checked_so():
    assert jaxtyping.jaxtyped is checked_at_first is not ALWAYS
    with pytest.raises(TypeCheckError):
        Frame.of("points")
