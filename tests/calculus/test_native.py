"""The machine code against the same formulas in torch and float64, and its parts against NumPy."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from weingarten.calculus import kernels
from weingarten.calculus.analytic import Analytic
from weingarten.calculus.jet import GRADIENT, TANGENT, VALUE
from weingarten.calculus.native import Native
from weingarten.crew import Crew
from weingarten.fields.siren import Siren
from weingarten.machine_code import is_kept

OUTPUTS = {VALUE: 1, GRADIENT: 2, TANGENT: 5}


def pair(width, depth, frequency=15.0, seed=0):
    """A field in float32, and in float64 with the same weights."""
    single = Siren(width, depth, frequency, torch.Generator().manual_seed(seed))
    double = Siren(width, depth, frequency).double()
    double.load_state_dict(single.state_dict())
    return single, double


def draw(count, seed=0):
    generator = torch.Generator().manual_seed(seed)
    points = 2.2 * torch.rand(count, 3, generator=generator) - 1.1
    return points, 6.3 * torch.rand(count, generator=generator)


def outputs(jet, order):
    return (jet.value, jet.gradient, jet.uu, jet.uv, jet.vv)[: OUTPUTS[order]]


def weight_gradients(field, jet, order, used, seed=0):
    """Of random multiples of the outputs of `used`, so that the others' cotangents are None."""
    generator = torch.Generator().manual_seed(seed)
    bars = [torch.randn(output.shape, generator=generator) for output in outputs(jet, order)]
    chosen = [row for row in zip(outputs(jet, order), bars, used, strict=False) if row[2]]
    return torch.autograd.grad(
        [output for output, _, _ in chosen],
        list(field.parameters()),
        [bar.to(output.dtype) for output, bar, _ in chosen],
        allow_unused=True,
        materialize_grads=True,
    )


def assert_near(found, expected, accuracy):
    """Within `accuracy` of the largest entry of each array."""
    for one, other in zip(found, expected, strict=True):
        assert one.shape == other.shape
        assert one.dtype == torch.float32
        assert (one - other).abs().max() <= accuracy * other.abs().max().clamp_min(1e-30)


@given(
    order=st.sampled_from((VALUE, GRADIENT, TANGENT)),
    used=st.tuples(*[st.booleans()] * 5),
    width=st.integers(1, 70),
    depth=st.integers(1, 5),
    count=st.integers(1, 2 * kernels.COLUMNS + 7),
    seed=st.integers(0, 1000),
)
@settings(max_examples=150)
def test_jets_and_weight_gradients_are_those_of_analytic_in_double(order, used, width, depth, count, seed):
    used = (used[0] or not any(used[: OUTPUTS[order]]), *used[1:])
    single, double = pair(width, depth, seed=seed)
    points, angles = draw(count, seed)
    found = Native(single)(points, order, angles)
    expected = Analytic(double)(points.double(), order, angles.double())
    for one, other in zip(outputs(found, order), outputs(expected, order), strict=True):
        assert (one - other).abs().max() <= 3e-5 * max(1.0, other.abs().max())
    got = weight_gradients(single, found, order, used)
    wanted = weight_gradients(double, expected, order, used)
    # a narrow field may be flat along u and v, and its block zero but for rounding
    whole = max(1.0, *(gradient.abs().max() for gradient in wanted))
    for one, other in zip(got, wanted, strict=True):
        assert one.dtype == torch.float32
        assert (one - other).abs().max() <= 1e-4 * whole


@pytest.mark.parametrize("width", [160, 256])
@pytest.mark.parametrize("order", [VALUE, GRADIENT, TANGENT])
def test_the_widths_of_the_presets(width, order):
    single, double = pair(width, 5, 30.0)
    points, angles = draw(600)
    found = Native(single)(points, order, angles)
    expected = Analytic(double)(points.double(), order, angles.double())
    assert_near(outputs(found, order), outputs(expected, order), 1e-4)
    used = (True,) * 5
    got = weight_gradients(single, found, order, used)
    assert_near(got, weight_gradients(double, expected, order, used), 3e-5)


@pytest.mark.parametrize("order", [VALUE, GRADIENT, TANGENT])
def test_inference_has_the_same_bits_no_graph_and_hands_its_buffers_back(order):
    field, _ = pair(48, 3)
    points, angles = draw(300)
    calculus = Native(field)
    trained = calculus(points, order, angles)
    with torch.no_grad():
        plain = calculus(points, order, angles)
        shelved = sum(len(shelf) for shelf in calculus.buffers.free.values())
        calculus(points, order, angles)
    assert not plain.value.requires_grad
    assert all(torch.equal(a, b) for a, b in zip(outputs(plain, order), outputs(trained, order), strict=True))
    assert sum(len(shelf) for shelf in calculus.buffers.free.values()) == shelved


def test_uninitialised_memory_is_not_read():
    """What lies beyond the last column of a tile, or was left by another piece, changes nothing."""
    field, _ = pair(40, 3)
    points, angles = draw(kernels.COLUMNS + 5)
    calculus = Native(field)
    used = (True,) * 5
    first = weight_gradients(field, calculus(points, TANGENT, angles), TANGENT, used)
    for shelf in calculus.buffers.free.values():
        for memory in shelf:
            memory.fill_(float("nan"))
    again = weight_gradients(field, calculus(points, TANGENT, angles), TANGENT, used)
    assert all(torch.equal(a, b) for a, b in zip(first, again, strict=True))


def test_pieces_at_once_are_pieces_one_after_the_other():
    field, _ = pair(48, 4)
    calculus = Native(field)
    used = (True,) * 5

    def gradients(seed):
        points, angles = draw(200, seed)
        return weight_gradients(field, calculus(points, TANGENT, angles), TANGENT, used)

    alone = [gradients(seed) for seed in range(8)]
    together = Crew(4).map(gradients, range(8))
    for one, other in zip(alone, together, strict=True):
        assert all(torch.equal(a, b) for a, b in zip(one, other, strict=True))


def test_weights_that_moved_are_seen():
    field, double = pair(32, 3)
    calculus, (points, _) = Native(field), draw(10)
    calculus(points, VALUE)
    with torch.no_grad():
        for one, other in zip(field.parameters(), double.parameters(), strict=True):
            one.mul_(1.5)
            other.mul_(1.5)
    expected = Analytic(double)(points.double(), VALUE).value
    assert_near([calculus(points, VALUE).value], [expected], 1e-4)


def test_a_second_backward_of_the_same_graph_raises():
    field, _ = pair(16, 3)
    points, angles = draw(40)
    total = Native(field)(points, TANGENT, angles).uv.abs().sum()
    total.backward(retain_graph=True)
    with pytest.raises(RuntimeError, match="once"):
        total.backward()


def test_other_types_are_refused():
    single, double = pair(16, 2)
    points, _ = draw(4)
    with pytest.raises(TypeError, match="float32"):
        Native(single)(points.double(), VALUE)
    with pytest.raises(TypeError, match="float32"):
        Native(double)(points.double(), VALUE)


@pytest.mark.parametrize("size", [1e-3, 1.0, 30.0, 1e3, 1e4])
def test_sines_and_cosines_are_right_to_a_few_units_of_the_last_place(size):
    x = np.random.default_rng(0).uniform(-size, size, 20_000).astype(np.float32)
    found = np.array([kernels.sin_cos(number) for number in x])
    exact = x.astype(np.float64)
    assert np.abs(found - np.stack([np.sin(exact), np.cos(exact)], axis=1)).max() < 2e-7


@given(rows=st.integers(1, 50), inner=st.integers(1, 50), count=st.integers(1, kernels.COLUMNS))
def test_products_are_those_of_numpy(rows, inner, count):
    generator = np.random.default_rng(rows + 100 * inner)

    def random(*shape):
        return generator.standard_normal(shape).astype(np.float32)

    V, x, out = random(rows, inner), random(inner, kernels.COLUMNS), random(rows, kernels.COLUMNS)
    kernels.product(V, x, out, count)
    np.testing.assert_allclose(out[:, :count], V @ x[:, :count], rtol=0, atol=1e-4)


@given(rows=st.integers(1, 70), count=st.integers(1, kernels.COLUMNS))
def test_outer_products_are_those_of_numpy(rows, count):
    generator = np.random.default_rng(rows)
    padded = -(-rows // kernels.PANEL) * kernels.PANEL
    y, x, before, room = (
        generator.standard_normal(shape).astype(np.float32)
        for shape in (*[(rows, kernels.COLUMNS)] * 2, (rows, padded), (padded, kernels.COLUMNS))
    )
    total = before.copy()
    kernels.add_outer(y, x, room, total, count)
    expected = before[:, :rows] + y[:, :count] @ x[:, :count].T
    np.testing.assert_allclose(total[:, :rows], expected, rtol=0, atol=1e-4)


def test_an_array_of_another_type_is_no_panel():
    V = np.zeros((8, 8))
    with pytest.raises(Exception, match="float32"):
        kernels.product(V, V, V, 8)


@pytest.mark.parametrize("size", [32, 64, 160])
def test_polar_is_the_polynomial_of_singular_values(size):
    generator = np.random.default_rng(0)
    matrix = generator.standard_normal((size, size)).astype(np.float32)
    a, b, c = (np.float32(number) for number in (3.4, -4.8, 2.0))
    u, s, vt = np.linalg.svd(matrix.astype(np.float64))
    s /= np.linalg.norm(s)
    for _ in range(5):
        s = a * s + b * s**3 + c * s**5
    np.testing.assert_allclose(kernels.polar(matrix, (a, b, c), 5), (u * s) @ vt, rtol=0, atol=1e-5)


def test_without_a_place_to_keep_machine_code_it_is_compiled_anew():
    names = {}
    exec("def doubled(x):\n    return 2 * x", names)  # of no file, so there is nowhere to keep it beside
    anew = kernels.machine_code(fastmath=True)(names["doubled"])
    assert anew(21) == 42
    assert not is_kept(anew)


def test_whether_machine_code_is_kept_is_known_before_it_is_called(tmp_path, monkeypatch):
    (tmp_path / "doubling.py").write_text("def doubled(x):\n    return 2 * x\n")
    monkeypatch.syspath_prepend(tmp_path)
    from doubling import doubled

    first = kernels.machine_code(fastmath=True)(doubled)
    assert not is_kept(first)
    first(21)
    assert is_kept(first)
    assert is_kept(kernels.machine_code(fastmath=True)(doubled)), "as another process finds it"
