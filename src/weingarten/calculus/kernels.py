"""Exact jets of a SIREN in float32 as machine code, a tile of columns at a time.

Formulas and symbols are those of `weingarten.calculus.analytic`. A tile is COLUMNS points, a column each: its
streams stay in a core's own cache from one product to the next, all that lies between two products is one
pass over them, and the interpreter is not asked for anything, so that threads do not wait for each other.
numba compiles what is here when it is first called and keeps it on disk; since it notices a change of this
file only, what is compiled together stays together.

A tape has the shape (tiles, streams, layers, width, COLUMNS); tile k of the points uses tape[k mod tiles], so
a tape of one tile serves whoever wants a jet and not its derivative. Its streams:

    A               a                       value alone, without its derivative
    COS             cos z                   with it
    LAMBDA          λ                       with the gradient
    T_U, T_V        t of u and of v         with the tangent block

What is one product of these is worked out again: that costs less than to fetch it. `passing` is room for
what lives no longer than a tile, (PASSING, width padded to whole panels, COLUMNS).

Points, directions and gradients are (3, n); so is a tangent block: uu, uv, vv.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import torch
from llvmlite import binding, ir
from numba import types
from numba.core.errors import TypingError
from numba.extending import intrinsic

from weingarten.machine_code import machine_code

COLUMNS = 96
A, COS, LAMBDA, T_U, T_V = range(5)
STREAMS = (2, 3, 5)
"""Streams of a tape that is to be differentiated, by the jet's order."""

W, Y, KEPT = 0, 1, 2
"""Kept by layer on the way back: room (KEPT, layers, width, COLUMNS)."""

DELTA, P_U, P_V, DELTA_BAR, Z_BAR, A_BAR, T_BAR_U, T_BAR_V, P_BAR_U, P_BAR_V, TURNED, LAMBDA_BAR = range(12)
PASSING = 13
"""Streams of `passing`: λ̄ has the last two, in turn."""

WIDE = bool(binding.get_host_cpu_features().get("avx512f", False))
ROWS, LANES = (8, 16) if WIDE else (4, 8)
"""A panel of a product is ROWS rows by two vectors of LANES numbers: what a processor's registers hold."""

PANEL = 2 * LANES


compiled: Any = machine_code(fastmath=True)
precisely: Any = machine_code(fastmath={"contract"})
emitted: Any = intrinsic(prefer_literal=True)


class Weights(NamedTuple):
    """A SIREN's.

    Times ω: first (width, 3), hidden and its transposes (layers − 1, width, width), biases (layers, width).
    As they are: head (width,), offset (1,).
    """

    first: np.ndarray
    hidden: np.ndarray
    back: np.ndarray
    biases: np.ndarray
    head: np.ndarray
    offset: np.ndarray


class Gradients(NamedTuple):
    """A loss's, in the same shapes; the columns of hidden are padded to whole panels."""

    first: np.ndarray
    hidden: np.ndarray
    biases: np.ndarray
    head: np.ndarray


def whole_panels(matrix):
    """Whether a tensor is one that `polar` and `descend` take."""
    square = matrix.dim() == 2 and matrix.shape[0] == matrix.shape[1] and matrix.shape[0] % PANEL == 0
    return square and matrix.is_contiguous() and matrix.device.type == "cpu" and matrix.dtype == torch.float32


@emitted
def panel(context, a, a_at, a_row, b, b_at, b_row, c, c_at, c_row, inner, rows, adds):
    """c ← a b + (c if adds): `rows` rows and PANEL columns, summed over `inner`.

    Of each array, where in its memory to begin and how long its rows are, in elements. In LLVM's own terms,
    since numba has no vectors: all sums stay in registers until they are complete.
    """
    check_single(a, b, c)
    size = types.intp
    signature = types.void(a, size, size, b, size, size, c, size, size, size, rows, types.boolean)

    def emit(context, builder, signature, arguments):
        a_, a_at_, a_row_, b_, b_at_, b_row_, c_, c_at_, c_row_, inner_, _, adds_ = arguments
        places = (a, a_, a_at_), (b, b_, b_at_), (c, c_, c_at_)
        starts = [start(context, builder, *place) for place in places]
        strides = [a_row_, b_row_, c_row_]
        emit_panel(builder, starts, strides, inner_, rows.literal_value, adds_)
        return context.get_dummy_value()

    return signature, emit


def check_single(*arrays):
    """Raise TypingError for an array of another type than float32: what follows would misread it."""
    if any(array.dtype != types.float32 or array.layout != "C" for array in arrays):
        raise TypingError("panels are of contiguous float32")


def start(context, builder, kind, array, offset):
    """Where an array's memory begins, so many elements on."""
    return builder.gep(context.make_array(kind)(context, builder, array).data, [offset])


def emit_panel(builder, starts, strides, inner, rows, adds):
    """The instructions of `panel`."""
    (a, b, c), (a_row, b_row, c_row) = starts, strides
    scalar, index = ir.FloatType(), ir.IntType(64)
    vector = ir.VectorType(scalar, LANES)

    def vectors(base, length, number):
        base = builder.gep(base, [builder.mul(length, number)])
        places = (builder.gep(base, [index(LANES * half)]) for half in range(2))
        return [builder.bitcast(place, vector.as_pointer()) for place in places]

    a_rows = [builder.gep(a, [builder.mul(a_row, index(row))]) for row in range(rows)]
    places = [place for row in range(rows) for place in vectors(c, c_row, index(row))]
    zero = ir.Constant(vector, None)
    before = [builder.select(adds, builder.load(place, align=4), zero) for place in places]
    entry, body, end = builder.block, builder.append_basic_block(), builder.append_basic_block()
    builder.branch(body)
    builder.position_at_end(body)
    k = builder.phi(index)
    sums = [builder.phi(vector) for _ in places]
    across = [builder.load(place, align=4) for place in vectors(b, b_row, k)]
    new = []
    for row in range(rows):
        one = builder.insert_element(zero, builder.load(builder.gep(a_rows[row], [k])), ir.IntType(32)(0))
        spread = builder.shuffle_vector(one, zero, ir.Constant(ir.VectorType(ir.IntType(32), LANES), None))
        for half in range(2):
            term = builder.fmul(spread, across[half], flags=("contract",))
            new.append(builder.fadd(term, sums[2 * row + half], flags=("contract",)))
    following = builder.add(k, index(1))
    for phi, first, then in zip([k, *sums], [index(0), *before], [following, *new], strict=True):
        phi.add_incoming(first, entry)
        phi.add_incoming(then, body)
    builder.cbranch(builder.icmp_signed("<", following, inner), body, end)
    builder.position_at_end(end)
    for place, value in zip(places, new, strict=True):
        builder.store(value, place, align=4)


@emitted
def turn_block(context, x, x_at, x_row, out, out_at, out_row):
    """out ← xᵀ for LANES rows and columns; where to begin and the length of rows as of `panel`."""
    check_single(x, out)
    size = types.intp

    def emit(context, builder, signature, arguments):
        x_, x_at_, x_row_, out_, out_at_, out_row_ = arguments
        begins = start(context, builder, x, x_, x_at_), start(context, builder, out, out_, out_at_)
        emit_turn_block(builder, begins[0], x_row_, begins[1], out_row_)
        return context.get_dummy_value()

    return types.void(x, size, size, out, size, size), emit


def emit_turn_block(builder, x, x_row, out, out_row):
    """The instructions of `turn_block`: off-diagonal blocks change places, of one number first, then two …"""
    index = ir.IntType(64)
    vector = ir.VectorType(ir.FloatType(), LANES)
    mask = ir.VectorType(ir.IntType(32), LANES)

    def row(base, length, number):
        return builder.bitcast(builder.gep(base, [builder.mul(length, index(number))]), vector.as_pointer())

    rows = [builder.load(row(x, x_row, i), align=4) for i in range(LANES)]
    side = 1
    while side < LANES:
        upper = [j if j & side == 0 else LANES + j - side for j in range(LANES)]
        lower = [j + side if j & side == 0 else LANES + j for j in range(LANES)]
        for i in (i for i in range(LANES) if i & side == 0):
            pair = rows[i], rows[i + side]
            rows[i] = builder.shuffle_vector(*pair, ir.Constant(mask, upper))
            rows[i + side] = builder.shuffle_vector(*pair, ir.Constant(mask, lower))
        side *= 2
    for i in range(LANES):
        builder.store(rows[i], row(out, out_row, i), align=4)


@compiled
def panels(a, a_row, b, b_row, c, c_row, inner, rows, columns, adds):
    """c ← a b + (c if adds), a panel at a time, for so many rows and the columns that panels cover."""
    whole = rows // ROWS * ROWS
    for j in range(0, columns, PANEL):
        for i in range(0, whole, ROWS):
            panel(a, i * a_row, a_row, b, j, b_row, c, i * c_row + j, c_row, inner, ROWS, adds)
        for i in range(whole, rows):
            panel(a, i * a_row, a_row, b, j, b_row, c, i * c_row + j, c_row, inner, 1, adds)


@compiled
def product(V, x, out, n):
    """out ← V x for the first n columns and those that fill their last panel."""
    rows, inner = V.shape
    panels(V, inner, x, x.shape[1], out, out.shape[1], inner, rows, n, False)


@compiled
def add_outer(y, x, turned, out, n):
    """out ← out + y xᵀ, sums over the first n columns; `turned` is room for xᵀ, out's columns are padded."""
    rows, inner = out.shape
    turn(x, turned, n, rows, inner)
    panels(y, y.shape[1], turned, inner, out, inner, n, rows, inner, True)


@compiled
def turn(x, out, n, rows, inner):
    """out ← xᵀ, its rows `inner` long, for x's first rows, first n columns and those that fill a block."""
    whole = rows // LANES * LANES
    flat = out.reshape(-1)
    for j in range(0, n, LANES):
        for i in range(0, whole, LANES):
            turn_block(x, i * x.shape[1] + j, x.shape[1], flat, j * inner + i, inner)
        for k in range(j, min(j + LANES, n)):
            for i in range(whole, rows):
                flat[k * inner + i] = x[i, k]


@compiled
def symmetric_product(x, y, out):
    """out ← x y for square matrices, whole panels wide. Half of it is enough: it is symmetric."""
    n = len(x)
    flat = out.reshape(-1)
    for j in range(0, n, PANEL):
        for i in range(j, n, ROWS):
            panel(x, i * n, n, y, j, n, out, i * n + j, n, n, ROWS, False)
    for j in range(0, n, LANES):
        for i in range(j + LANES, n, LANES):
            turn_block(out, i * n + j, n, flat, j * n + i, n)


@compiled
def polar(x, coefficients, times):
    """x ← ax + bx³ + cx⁵, so often, from x over its Frobenius norm; square, a whole number of panels wide."""
    a, b, c = coefficients
    n = len(x)
    total = np.float32(0.0)
    for i in range(n):
        for j in range(n):
            total += x[i, j] * x[i, j]
    y = x / np.float32(max(math.sqrt(total), 1e-30))
    gram, polynomial, scratch = np.empty_like(y), np.empty_like(y), np.empty_like(y)
    for _ in range(times):
        turn(y, scratch, n, n, n)
        symmetric_product(y, scratch, gram)
        symmetric_product(gram, gram, polynomial)
        for i in range(n):
            for j in range(n):
                polynomial[i, j] = c * polynomial[i, j] + b * gram[i, j]
        product(polynomial, y, scratch, n)
        for i in range(n):
            for j in range(n):
                y[i, j] = a * y[i, j] + scratch[i, j]
    return y


@compiled
def descend(weight, gradient, momentum, mu, factor, coefficients, times):
    """momentum ← μ momentum + gradient, weight ← weight + factor polar(gradient + μ momentum)."""
    n = len(weight)
    update = np.empty_like(gradient)
    for i in range(n):
        for j in range(n):
            momentum[i, j] = mu * momentum[i, j] + gradient[i, j]
            update[i, j] = gradient[i, j] + mu * momentum[i, j]
    update = polar(update, coefficients, times)
    for i in range(n):
        for j in range(n):
            weight[i, j] += factor * update[i, j]


@compiled
def first_product(V, x, out, n):
    """out ← V x for x (3, n)."""
    for i in range(V.shape[0]):
        for j in range(n):
            out[i, j] = V[i, 0] * x[0, j] + V[i, 1] * x[1, j] + V[i, 2] * x[2, j]


@compiled
def add_first_outer(y, x, out, n):
    """out ← out + y xᵀ for x (3, n)."""
    for i in range(out.shape[0]):
        a = b = c = np.float32(0.0)
        for j in range(n):
            a += y[i, j] * x[0, j]
            b += y[i, j] * x[1, j]
            c += y[i, j] * x[2, j]
        out[i, 0] += a
        out[i, 1] += b
        out[i, 2] += c


@precisely
def sin_cos(x):
    """(sin x, cos x), radians, to 1e-7 for |x| < 10⁴: Cody and Waite's reduction, Cephes' polynomials."""
    k = np.rint(x * np.float32(0.6366197723675814))
    r = x - k * np.float32(1.5703125)
    r = r - k * np.float32(4.837512969970703e-4)
    r = r - k * np.float32(7.549789948768648e-8)
    s = r * r
    p = np.float32(-1.9515295891e-4) * s + np.float32(8.3321608736e-3)
    sine = (p * s + np.float32(-1.6666654611e-1)) * s * r + r
    p = np.float32(2.443315711809948e-5) * s + np.float32(-1.388731625493765e-3)
    p = p * s + np.float32(4.166664568298827e-2)
    cosine = p * s * s - np.float32(0.5) * s + np.float32(1.0)
    quarter = np.int32(k)
    odd = (quarter & 1) != 0
    first = cosine if odd else sine
    second = sine if odd else cosine
    return (
        -first if (quarter & 2) != 0 else first,
        -second if ((quarter + 1) & 2) != 0 else second,
    )


@compiled
def forward(points, angles, weights, tape, passing, value, gradient, frames, block, order):
    """Fills the tape, value (n,) and, as far as `order` asks, gradient, frames (6, n) of u above v, block."""
    columns = tape.shape[4]
    for start in range(0, points.shape[1], columns):
        n = min(columns, points.shape[1] - start)
        tile = tape[start // columns % tape.shape[0]]
        span = slice(start, start + n)
        forward_tile(points[:, span], weights, tile, value[span])
        if order >= 1:
            reverse_tile(weights, tile, passing[DELTA], gradient[:, span])
        if order >= 2:
            frame_tile(gradient[:, span], angles[span], frames[:, span])
            push_tile(weights, tile, passing, frames[:, span], block[:, span])


@compiled
def forward_tile(points, weights, tile, value):
    """f."""
    n = len(value)
    for layer in range(tile.shape[1]):
        a, biases = tile[A, layer], weights.biases[layer]
        if layer == 0:
            first_product(weights.first, points, a, n)
        else:
            product(weights.hidden[layer - 1], tile[A, layer - 1], a, n)
        if tile.shape[0] > COS:
            cos = tile[COS, layer]
            for i in range(a.shape[0]):
                for j in range(n):
                    a[i, j], cos[i, j] = sin_cos(a[i, j] + biases[i])
        else:
            for i in range(a.shape[0]):
                for j in range(n):
                    a[i, j] = sin_cos(a[i, j] + biases[i])[0]
    value[:] = weights.offset[0]
    a = tile[A, tile.shape[1] - 1]
    for i in range(a.shape[0]):
        for j in range(n):
            value[j] += weights.head[i] * a[i, j]


@compiled
def multiply(x, y, out, n):
    """out ← x y, element by element."""
    for i in range(x.shape[0]):
        for j in range(n):
            out[i, j] = x[i, j] * y[i, j]


@compiled
def reverse_tile(weights, tile, delta, gradient):
    """∇f."""
    n, last = gradient.shape[1], tile.shape[1] - 1
    for i in range(tile.shape[2]):
        tile[LAMBDA, last, i, :n] = weights.head[i]
    for layer in range(last, -1, -1):
        multiply(tile[COS, layer], tile[LAMBDA, layer], delta, n)
        if layer > 0:
            product(weights.back[layer - 1], delta, tile[LAMBDA, layer - 1], n)
    gradient[:] = 0.0
    first = weights.first
    for i in range(first.shape[0]):
        for j in range(n):
            gradient[0, j] += first[i, 0] * delta[i, j]
            gradient[1, j] += first[i, 1] * delta[i, j]
            gradient[2, j] += first[i, 2] * delta[i, j]


@compiled
def frame_tile(gradient, angles, frames):
    """Orthonormal (u, v) ⟂ ∇f, those of `weingarten.calculus.jet.tangent_frame`."""
    for j in range(gradient.shape[1]):
        x, y, z = gradient[0, j], gradient[1, j], gradient[2, j]
        norm = max(math.sqrt(x * x + y * y + z * z), 1e-12)
        x, y, z = x / norm, y / norm, z / norm
        sign = -1.0 if z < 0 else 1.0
        a = -1.0 / (sign + z)
        b = x * y * a
        cosine, sine = math.cos(angles[j]), math.sin(angles[j])
        e1 = (1.0 + sign * x * x * a, sign * b, -sign * x)
        e2 = (b, sign + y * y * a, -y)
        for axis in range(3):
            frames[axis, j] = cosine * e1[axis] + sine * e2[axis]
            frames[3 + axis, j] = cosine * e2[axis] - sine * e1[axis]


@compiled
def push_tile(weights, tile, passing, frames, block):
    """uᵀHu, uᵀHv, vᵀHv."""
    n = block.shape[1]
    block[:] = 0.0
    for layer in range(tile.shape[1]):
        t_u, t_v, p_u, p_v = tile[T_U, layer], tile[T_V, layer], passing[P_U], passing[P_V]
        if layer == 0:
            first_product(weights.first, frames[:3], t_u, n)
            first_product(weights.first, frames[3:], t_v, n)
        else:
            product(weights.hidden[layer - 1], p_u, t_u, n)
            product(weights.hidden[layer - 1], p_v, t_v, n)
        a, cos, scale = tile[A, layer], tile[COS, layer], tile[LAMBDA, layer]
        for i in range(a.shape[0]):
            for j in range(n):
                u, v, q = t_u[i, j], t_v[i, j], a[i, j] * scale[i, j]
                block[0, j] -= q * u * u
                block[1, j] -= q * u * v
                block[2, j] -= q * v * v
                p_u[i, j] = cos[i, j] * u
                p_v[i, j] = cos[i, j] * v


@compiled
def backward(points, weights, tape, frames, value, gradient, block, kept, passing, out, order):
    """Leaves a loss's gradients in `out`, given its cotangents of value (n,), gradient and block.

    Those of first, hidden and biases are with respect to ω times these.
    """
    columns = tape.shape[4]
    out.first[:] = 0.0
    out.hidden[:] = 0.0
    out.biases[:] = 0.0
    out.head[:] = 0.0
    for start in range(0, points.shape[1], columns):
        n = min(columns, points.shape[1] - start)
        tile = tape[start // columns]
        span = slice(start, start + n)
        if order >= 2:
            push_backward_tile(weights, tile, frames[:, span], block[:, span], kept, passing, out)
        if order >= 1:
            reverse_backward_tile(weights, tile, gradient[:, span], kept, passing, out, order)
        forward_backward_tile(points[:, span], weights, tile, value[span], kept, passing, out, order)


@compiled
def push_backward_tile(weights, tile, frames, block, kept, passing, out):
    """From the tangent block's cotangents to t̄, w and y."""
    n, last = block.shape[1], tile.shape[1] - 1
    t_bar_u, t_bar_v, turned = passing[T_BAR_U], passing[T_BAR_V], passing[TURNED]
    p_bar_u, p_bar_v = passing[P_BAR_U], passing[P_BAR_V]
    p_bar_u[:, :n] = 0.0
    p_bar_v[:, :n] = 0.0
    for layer in range(last, -1, -1):
        a, cos, scale = tile[A, layer], tile[COS, layer], tile[LAMBDA, layer]
        t_u, t_v, w, y = tile[T_U, layer], tile[T_V, layer], kept[W, layer], kept[Y, layer]
        for i in range(a.shape[0]):
            for j in range(n):
                u, v = t_u[i, j], t_v[i, j]
                # half the derivative of the quadratic form with respect to u and v
                half = np.float32(0.5) * block[1, j]
                g_u = block[0, j] * u + half * v
                g_v = block[2, j] * v + half * u
                w[i, j] = u * g_u + v * g_v
                y[i, j] = u * p_bar_u[i, j] + v * p_bar_v[i, j]
                twice = np.float32(2.0) * a[i, j] * scale[i, j]
                t_bar_u[i, j] = cos[i, j] * p_bar_u[i, j] - twice * g_u
                t_bar_v[i, j] = cos[i, j] * p_bar_v[i, j] - twice * g_v
        if layer > 0:
            hidden, back = out.hidden[layer - 1], weights.back[layer - 1]
            p, cos = passing[P_U], tile[COS, layer - 1]
            multiply(cos, tile[T_U, layer - 1], p, n)
            add_outer(t_bar_u, p, turned, hidden, n)
            multiply(cos, tile[T_V, layer - 1], p, n)
            add_outer(t_bar_v, p, turned, hidden, n)
            product(back, t_bar_u, p_bar_u, n)
            product(back, t_bar_v, p_bar_v, n)
        else:
            add_first_outer(t_bar_u, frames[:3], out.first, n)
            add_first_outer(t_bar_v, frames[3:], out.first, n)


@compiled
def reverse_backward_tile(weights, tile, gradient, kept, passing, out, order):
    """From the gradient's cotangent to λ̄ and y."""
    n, last = gradient.shape[1], tile.shape[1] - 1
    delta, delta_bar = passing[DELTA], passing[DELTA_BAR]
    for layer in range(last + 1):
        lambda_bar, above = passing[LAMBDA_BAR + layer % 2], passing[LAMBDA_BAR + (layer + 1) % 2]
        multiply(tile[COS, layer], tile[LAMBDA, layer], delta, n)
        if layer == 0:
            first_product(weights.first, gradient, delta_bar, n)
            add_first_outer(delta, gradient, out.first, n)
        else:
            product(weights.hidden[layer - 1], above, delta_bar, n)
            add_outer(delta, above, passing[TURNED], out.hidden[layer - 1], n)
        a, cos, scale = tile[A, layer], tile[COS, layer], tile[LAMBDA, layer]
        w, y = kept[W, layer], kept[Y, layer]
        for i in range(a.shape[0]):
            if order >= 2:
                for j in range(n):
                    lambda_bar[i, j] = delta_bar[i, j] * cos[i, j] - a[i, j] * w[i, j]
                    y[i, j] += delta_bar[i, j] * scale[i, j]
            else:
                for j in range(n):
                    lambda_bar[i, j] = delta_bar[i, j] * cos[i, j]
                    y[i, j] = delta_bar[i, j] * scale[i, j]
    lambda_bar = passing[LAMBDA_BAR + last % 2]
    for i in range(len(out.head)):
        total = np.float32(0.0)
        for j in range(n):
            total += lambda_bar[i, j]
        out.head[i] += total


@compiled
def forward_backward_tile(points, weights, tile, value, kept, passing, out, order):
    """From the value's cotangent, and all that came before, to the gradients."""
    n, last = len(value), tile.shape[1] - 1
    a_bar, z_bar, head = passing[A_BAR], passing[Z_BAR], weights.head
    a = tile[A, last]
    for i in range(len(head)):
        total = np.float32(0.0)
        for j in range(n):
            total += a[i, j] * value[j]
            a_bar[i, j] = head[i] * value[j]
        out.head[i] += total
    for layer in range(last, -1, -1):
        a, cos, y = tile[A, layer], tile[COS, layer], kept[Y, layer]
        for i in range(a.shape[0]):
            total = np.float32(0.0)
            if order >= 2:
                scale, w = tile[LAMBDA, layer], kept[W, layer]
                for j in range(n):
                    a_bar[i, j] -= scale[i, j] * w[i, j]
            if order >= 1:
                for j in range(n):
                    z_bar[i, j] = a_bar[i, j] * cos[i, j] - a[i, j] * y[i, j]
                    total += z_bar[i, j]
            else:
                for j in range(n):
                    z_bar[i, j] = a_bar[i, j] * cos[i, j]
                    total += z_bar[i, j]
            out.biases[layer, i] += total
        if layer > 0:
            add_outer(z_bar, tile[A, layer - 1], passing[TURNED], out.hidden[layer - 1], n)
            product(weights.back[layer - 1], z_bar, a_bar, n)
        else:
            add_first_outer(z_bar, points, out.first, n)
