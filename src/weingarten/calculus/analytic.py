"""Exact jets of a SIREN by one forward, one reverse and two tangent streams, with a hand-written backward.

Method §3. Layer l = 0 … L−1 of a SIREN, with ω folded into V = ωW and c = ωb:

    z_l = V_l a_{l−1} + c_l,   a_l = sin z_l,   f = w·a_{L−1} + b
    λ_{L−1} = w,   δ_l = λ_l cos z_l,   λ_{l−1} = V_lᵀ δ_l,   ∇f = V_0ᵀ δ_0        (reverse)
    t_0 = V_0 d,   p_l = cos z_l · t_l,   t_{l+1} = V_{l+1} p_l                    (tangents, d = u, v)
    aᵀ H b = −Σ_l λ_l sin z_l · t_l(a) · t_l(b)

All are ordinary products, so a training step needs one backward pass and no double backward. A bar is a
cotangent: z̄ = ∂loss/∂z. Every stream's part of ∂loss/∂V_l is an outer product, so they are stacked by rows,

    ∂loss/∂V_l = leftᵀ right,   left = [z̄_l; δ_l; t̄_l(u); t̄_l(v)]
                                right = [a_{l−1}; λ̄_{l−1}; p_{l−1}(u); p_{l−1}(v)]

and cost one product. Arithmetic, in forward passes a point: value 1 + 2, with gradient 2 + 4, with the
tangent block 4 + 8.
"""

from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.buffers import Buffers
from weingarten.calculus.jet import GRADIENT, TANGENT, VALUE, Jet, tangent_frame
from weingarten.calculus.product import affine, product
from weingarten.fields.siren import Siren

STREAMS = {VALUE: 1, GRADIENT: 2, TANGENT: 4}
"""Rows of n points in `left` and `right`: forward; reverse; the tangents u and v."""


class Analytic:
    """The calculus of one SIREN: `Analytic(field)(points, order, angles)` is its jet.

    Differentiable once with respect to the field's weights; not with respect to the points.
    """

    def __init__(self, field: Siren) -> None:
        self.field = field
        self.buffers = Buffers()

    def __call__(
        self, points: Float[Tensor, "n 3"], order: int, angles: Float[Tensor, " n"] | None = None
    ) -> Jet:
        """See `weingarten.calculus.jet.Calculus`."""
        if angles is None:
            angles = points.new_zeros(len(points))
        field = self.field
        # within a Function's forward the grad mode is off, and needs_input_grad ignores no_grad
        trains = torch.is_grad_enabled() and any(weight.requires_grad for weight in field.parameters())
        parameters = (*field.weights, *field.biases)
        return Jet(*_Jet.apply(points, order, angles, trains, self.buffers, field.frequency, *parameters))


class _Jet(torch.autograd.Function):
    """Values, gradients and tangent blocks out; their cotangents in."""

    @staticmethod
    def forward(
        ctx: Any,
        points: Float[Tensor, "n 3"],
        order: int,
        angles: Float[Tensor, " n"],
        trains: bool,
        buffers: Buffers,
        frequency: float,
        *parameters: Tensor,
    ) -> tuple[Tensor, ...]:
        half = len(parameters) // 2
        tape = _Tape(points, order, trains, buffers, frequency, parameters[:half], parameters[half:])
        value = tape.forward()
        outputs = [value]
        if order >= GRADIENT:
            outputs.append(tape.reverse())
        if order >= TANGENT:
            outputs += tape.push(torch.cat(tangent_frame(outputs[1], angles)))
        ctx.set_materialize_grads(False)
        if trains:
            ctx.tape = tape
        else:
            tape.release()
        return tuple(outputs)

    @staticmethod
    def backward(ctx: Any, *bars: Tensor | None) -> tuple[Tensor | None, ...]:
        if ctx.tape is None:
            raise RuntimeError("a jet can be differentiated once: its buffers have been handed back")
        tape: _Tape = ctx.tape
        ctx.tape = None
        n = len(tape.points)
        value, gradient, *block = (*bars, None, None, None, None)[:5]
        if tape.order >= TANGENT:
            tape.push_backward(*block)
        if tape.order >= GRADIENT:
            tape.reverse_backward(tape.points.new_zeros(n, 3) if gradient is None else gradient)
        weights, biases = tape.forward_backward(tape.points.new_zeros(n) if value is None else value)
        tape.release()
        return None, None, None, None, None, None, *weights, *biases


class _Tape:
    """One batch's streams, kept from the forward to the backward pass; arrays of n·width are buffers."""

    def __init__(
        self,
        points: Float[Tensor, "n 3"],
        order: int,
        trains: bool,
        buffers: Buffers,
        frequency: float,
        weights: tuple[Tensor, ...],
        biases: tuple[Tensor, ...],
    ) -> None:
        self.points, self.order, self.buffers, self.frequency = points, order, buffers, frequency
        self.has_slopes = trains or order >= GRADIENT
        self.V = [frequency * w for w in weights[:-1]]
        self.c = [frequency * b for b in biases[:-1]]
        self.head, self.offset = weights[-1], biases[-1]
        n, rows = len(points), STREAMS[order] * len(points)
        self.n, self.depth, self.width = n, len(self.V), self.head.shape[1]
        self.taken: list[Tensor] = []
        self.left = [self.take(rows, self.width) for _ in self.V] if self.has_slopes else []
        # right[l] enters layer l; right[depth] enters the head, which no tangent passes.
        self.right = [points.new_empty(rows, 3), *(self.take(rows, self.width) for _ in self.V)]
        self.right[0][:n] = points
        self.cos: list[Tensor] = []
        self.lambdas: list[Tensor] = [self.head] * self.depth
        self.tangents: list[Tensor] = []
        self.q: list[Tensor] = []
        # The tangent block adds −sin z_l · w_l to λ̄_l; y_l gathers all that multiplies −sin z_l in z̄_l.
        self.w: list[Tensor | None] = [None] * self.depth
        self.y: list[Tensor | None] = [None] * self.depth

    def take(self, *shape: int) -> Tensor:
        """A buffer that lives until `release`."""
        self.taken.append(self.buffers.take(self.points, *shape))
        return self.taken[-1]

    def release(self) -> None:
        """Hand the buffers back; the tape is spent."""
        self.buffers.give_back(*self.taken)
        self.taken.clear()

    def sin(self, layer: int) -> Tensor:
        """a_l = sin z_l."""
        return self.right[layer + 1][: self.n]

    def forward(self) -> Float[Tensor, " n"]:
        """f."""
        for layer in range(self.depth):
            z = affine(self.right[layer][: self.n], self.V[layer], self.c[layer])
            torch.sin(z, out=self.sin(layer))
            if self.has_slopes:
                self.cos.append(torch.cos(z, out=self.take(self.n, self.width)))
        return self.sin(self.depth - 1) @ self.head[0] + self.offset

    def reverse(self) -> Float[Tensor, "n 3"]:
        """∇f."""
        delta = self.head
        for layer in reversed(range(self.depth)):
            delta = self.left[layer][self.n : 2 * self.n]
            torch.mul(self.cos[layer], self.lambdas[layer], out=delta)
            if layer > 0:
                self.lambdas[layer - 1] = product(delta, self.V[layer])
        return delta @ self.V[0]

    def push(self, directions: Float[Tensor, "m 3"]) -> tuple[Tensor, Tensor, Tensor]:
        """uᵀHu, uᵀHv, vᵀHv along the rows of `directions`: all u, then all v."""
        n, pair = self.n, (2, self.n, self.width)
        self.right[0][2 * n :] = directions
        scratch, uu, uv, vv = self.take(4, n, self.width).unbind()
        for total in (uu, uv, vv):
            total.zero_()
        for layer in range(self.depth):
            q = torch.mul(self.sin(layer), self.lambdas[layer], out=self.take(n, self.width))
            t = product(self.right[layer][2 * n :], self.V[layer].t()).view(pair)
            self.q.append(q)
            self.tangents.append(t)
            torch.mul(q, t[0], out=scratch)
            uu.addcmul_(scratch, t[0])
            uv.addcmul_(scratch, t[1])
            torch.mul(q, t[1], out=scratch)
            vv.addcmul_(scratch, t[1])
            if layer + 1 < self.depth:
                torch.mul(self.cos[layer], t, out=self.right[layer + 1][2 * n :].view(pair))
        return -uu.sum(-1), -uv.sum(-1), -vv.sum(-1)

    def push_backward(self, uu: Tensor | None, uv: Tensor | None, vv: Tensor | None) -> None:
        """From the tangent block's cotangents to t̄ (into `left`), w and y."""
        n, pair = self.n, (2, self.n, self.width)
        diagonal = torch.stack([torch.zeros_like(self.points[:, 0]) if x is None else x for x in (uu, vv)])
        half = torch.zeros_like(self.points[:, 0]) if uv is None else 0.5 * uv
        p_bar = None
        G = self.take(*pair)
        for layer in reversed(range(self.depth)):
            t, t_bar = self.tangents[layer], self.left[layer][2 * n :].view(pair)
            # G = (uū t_u + ½ uv̄ t_v, vv̄ t_v + ½ uv̄ t_u): half the derivative of the quadratic form.
            torch.mul(t[1], half.unsqueeze(-1), out=G[0])
            torch.mul(t[0], half.unsqueeze(-1), out=G[1])
            if uu is not None or vv is not None:
                G.addcmul_(t, diagonal.unsqueeze(-1))
            w = torch.mul(t[0], G[0], out=self.take(n, self.width))
            self.w[layer] = w.addcmul_(t[1], G[1])
            torch.mul(self.q[layer], G.mul_(-2.0), out=t_bar)
            if p_bar is not None:
                y = torch.mul(t[0], p_bar[0], out=self.take(n, self.width))
                self.y[layer] = y.addcmul_(t[1], p_bar[1])
                t_bar.addcmul_(self.cos[layer], p_bar)
            if layer > 0:
                p_bar = product(self.left[layer][2 * n :], self.V[layer]).view(pair)

    def reverse_backward(self, gradient: Float[Tensor, "n 3"]) -> None:
        """From the gradient's cotangent to λ̄ (into `right`) and y."""
        n = self.n
        self.right[0][n : 2 * n] = gradient
        for layer in range(self.depth):
            delta_bar = product(self.right[layer][n : 2 * n], self.V[layer].t())
            lambda_bar = torch.mul(delta_bar, self.cos[layer], out=self.right[layer + 1][n : 2 * n])
            w, y = self.w[layer], self.y[layer]
            if w is not None:
                lambda_bar.addcmul_(self.sin(layer), w, value=-1.0)
            delta_bar.mul_(self.lambdas[layer])
            self.y[layer] = delta_bar if y is None else y.add_(delta_bar)

    def forward_backward(self, value: Float[Tensor, " n"]) -> tuple[list[Tensor], list[Tensor]]:
        """From the value's cotangent, and all that came before, to the gradients of weights and biases."""
        n = self.n
        head = (value @ self.sin(self.depth - 1)).unsqueeze(0)
        if self.order >= GRADIENT:
            head += self.right[self.depth][n : 2 * n].sum(0)
        weights, biases = [head], [value.sum().unsqueeze(0)]
        a_bar = value.unsqueeze(-1) * self.head
        transposed = self.take(self.width, len(self.left[0]))
        for layer in reversed(range(self.depth)):
            w, y = self.w[layer], self.y[layer]
            if w is not None:
                a_bar.addcmul_(self.lambdas[layer], w, value=-1.0)
            z_bar = torch.mul(self.cos[layer], a_bar, out=self.left[layer][:n])
            if y is not None:
                z_bar.addcmul_(self.sin(layer), y, value=-1.0)
            weights.append(
                product(transposed.copy_(self.left[layer].t()), self.right[layer]).mul_(self.frequency)
            )
            biases.append(z_bar.sum(0).mul_(self.frequency))
            if layer > 0:
                a_bar = product(z_bar, self.V[layer])
        return weights[::-1], biases[::-1]
