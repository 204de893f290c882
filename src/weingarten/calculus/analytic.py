"""Exact jets of SIRENs by one forward, one reverse and a few tangent streams, with a hand-written backward.

Method §3. Layer l = 0 … L−1 of a SIREN, with ω folded into V = ωW and c = ωb:

    z_l = V_l a_{l−1} + c_l,   a_l = sin z_l,   f = w·a_{L−1} + b
    λ_{L−1} = w,   δ_l = λ_l cos z_l,   λ_{l−1} = V_lᵀ δ_l,   ∇f = V_0ᵀ δ_0        (reverse)
    t_0 = V_0 d,   p_l = cos z_l · t_l,   t_{l+1} = V_{l+1} p_l              (tangents, d = u, v and n)
    aᵀ H b = −Σ_l λ_l sin z_l · t_l(a) · t_l(b)

All are ordinary products, so a training step needs one backward pass and no double backward. A bar is a
cotangent: z̄ = ∂loss/∂z. Every stream gives ∂loss/∂V_l one outer product,

    ∂loss/∂V_l = z̄_l a_{l−1}ᵀ + δ_l λ̄_{l−1}ᵀ + Σ_d t̄_l(d) p_{l−1}(d)ᵀ.

A stream is an array (width, n), a column a point: as the formulas above are written, and so that neither
these products nor those with V and Vᵀ have to copy a transpose of n columns. Of an ensemble of m SIRENs it is
(m, width, n), V is (m, width, width), and every product is m of them. Arithmetic, in forward passes a point:
value 1 + 2, with gradient 2 + 4, with the tangent block 4 + 8, with the whole Hessian 5 + 10.
"""

from collections.abc import Sequence
from threading import Lock
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.calculus.buffers import Buffers
from weingarten.calculus.jet import GRADIENT, PAIRS, TANGENT, Jet, directions
from weingarten.fields.ensemble import Ensemble
from weingarten.fields.siren import Siren


class Analytic:
    """The calculus of one SIREN, or of an ensemble: `Analytic(field)(points, order, angles)` is its jet.

    Differentiable once with respect to the field's weights; not with respect to the points.
    """

    def __init__(self, field: Siren | Ensemble) -> None:
        self.field = field
        self.buffers = Buffers()
        self.lock = Lock()
        self.scaled: _Scaled | None = None

    def __call__(
        self, points: Float[Tensor, "n *m 3"], order: int, angles: Float[Tensor, "n *m"] | None = None
    ) -> Jet:
        """See `weingarten.calculus.jet.Calculus`."""
        if angles is None:
            angles = points.new_zeros(points.shape[:-1])
        field = self.field
        # within a Function's forward the grad mode is off, and needs_input_grad ignores no_grad
        trains = torch.is_grad_enabled() and any(weight.requires_grad for weight in field.parameters())
        parameters = (*field.weights, *field.biases)
        return Jet(*_Jet.apply(points, order, angles, trains, self.buffers, self.present(), *parameters))

    def present(self) -> "_Scaled":
        """The field's weights as they are now, worked out once for all pieces of a step."""
        with self.lock:
            if self.scaled is None or self.scaled.version != version(self.field):
                self.scaled = _Scaled(self.field)
            return self.scaled


class _Scaled:
    """ω times the weights and biases of the sine layers, and these weights transposed; without a graph."""

    def __init__(self, field: Siren | Ensemble) -> None:
        self.version = version(field)
        self.frequency = field.frequency
        with torch.no_grad():
            self.V = [field.frequency * weight for weight in list(field.weights)[:-1]]
            self.c = [(field.frequency * bias).unsqueeze(-1) for bias in list(field.biases)[:-1]]
            self.Vt = [V.mT.contiguous() for V in self.V]
            self.head, self.offset = field.weights[-1].detach(), field.biases[-1].detach()


def version(field: nn.Module) -> list[tuple[int, int]]:
    """Where the weights lie and how often they were written to; writes through `.data` are not counted."""
    return [(weight.data_ptr(), weight._version) for weight in field.parameters()]


class _Jet(torch.autograd.Function):
    """Values, gradients and second derivatives out; their cotangents in."""

    @staticmethod
    def forward(
        ctx: Any,
        points: Float[Tensor, "n *m 3"],
        order: int,
        angles: Float[Tensor, "n *m"],
        trains: bool,
        buffers: Buffers,
        scaled: _Scaled,
        *parameters: Tensor,
    ) -> tuple[Tensor, ...]:
        tape = _Tape(points, order, trains, buffers, scaled)
        value = tape.forward()
        outputs = [value]
        if order >= GRADIENT:
            outputs.append(tape.reverse())
        if order >= TANGENT:
            outputs += tape.push(directions(outputs[1], angles, order))
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
        # all that follows is linear in the cotangents, so the ω of V = ωW is theirs from the beginning
        scaled = (None if bar is None else tape.frequency * columns(bar) for bar in bars)
        value, gradient, *block = (*scaled, None)
        if tape.order >= TANGENT:
            tape.push_backward(block)
        if tape.order >= GRADIENT:
            tape.reverse_backward(torch.zeros_like(tape.inputs[0]) if gradient is None else gradient)
        weights, biases = tape.forward_backward(tape.zeros() if value is None else value)
        tape.release()
        return None, None, None, None, None, None, *weights, *biases


def columns(rows: Float[Tensor, "n *rest"]) -> Float[Tensor, "*rest n"]:
    """The points of an array last: (n, 3) as a stream (3, n), (n, m, 3) as (m, 3, n)."""
    return rows.movedim(0, -1)


def rows(columns: Float[Tensor, "*rest n"]) -> Float[Tensor, "n *rest"]:
    """The inverse of `columns`, in memory of its own."""
    return columns.movedim(-1, 0).contiguous()


class _Tape:
    """One piece's streams, kept from the forward to the backward pass.

    What enters layer l, and so leaves layer l − 1: inputs (a), lambda_bars (λ̄), pushed (p by direction).
    By layer: cos (of z), lambdas (λ), deltas (δ), q = a λ, tangents (t by direction), t_bars; second
    derivatives add −a w to λ̄; y is all that multiplies −a in z̄.
    """

    def __init__(
        self,
        points: Float[Tensor, "n *m 3"],
        order: int,
        trains: bool,
        buffers: Buffers,
        scaled: _Scaled,
    ) -> None:
        self.points, self.order, self.buffers, self.frequency = points, order, buffers, scaled.frequency
        self.has_slopes = trains or order >= GRADIENT
        self.V, self.Vt, self.c = scaled.V, scaled.Vt, scaled.c
        self.head, self.offset = scaled.head, scaled.offset
        self.depth = len(self.V)
        self.shape = (*points.shape[1:-1], self.head.shape[-1], len(points))
        self.taken: list[Tensor] = []
        self.inputs: list[Tensor] = [columns(points)]
        self.cos: list[Tensor] = []
        self.lambdas: list[Tensor] = [self.head.mT] * self.depth
        self.deltas: list[Tensor] = [self.head] * self.depth
        self.lambda_bars: list[Tensor] = []
        self.q: list[Tensor] = []
        self.pushed: list[list[Tensor]] = []
        self.tangents: list[list[Tensor]] = []
        self.t_bars: list[list[Tensor]] = []
        self.w: list[Tensor | None] = [None] * self.depth
        self.y: list[Tensor | None] = [None] * self.depth

    def take(self) -> Float[Tensor, "*m width n"]:
        """A buffer that lives until `release`."""
        self.taken.append(self.buffers.take(self.points, *self.shape))
        return self.taken[-1]

    def zeros(self) -> Float[Tensor, "*m n"]:
        """A cotangent of values that nothing depends on."""
        return columns(self.points.new_zeros(self.points.shape[:-1]))

    def release(self) -> None:
        """Hand the buffers back; the tape is spent."""
        self.buffers.give_back(*self.taken)
        self.taken.clear()

    def sin(self, layer: int) -> Float[Tensor, "*m width n"]:
        """a_l = sin z_l."""
        return self.inputs[layer + 1]

    def forward(self) -> Float[Tensor, "n *m"]:
        """f."""
        for V, c in zip(self.V, self.c, strict=True):
            z = (V @ self.inputs[-1]).add_(c)
            if self.has_slopes:
                self.cos.append(torch.cos(z, out=self.take()))
            self.inputs.append(torch.sin(z, out=self.take() if self.has_slopes else z))
        return rows((self.head @ self.inputs[-1]).squeeze(-2) + self.offset)

    def reverse(self) -> Float[Tensor, "n *m 3"]:
        """∇f."""
        for layer in reversed(range(self.depth)):
            self.deltas[layer] = torch.mul(self.cos[layer], self.lambdas[layer], out=self.take())
            if layer > 0:
                self.lambdas[layer - 1] = self.Vt[layer] @ self.deltas[layer]
        return rows(self.Vt[0] @ self.deltas[0])

    def push(self, frame: tuple[Float[Tensor, "n *m 3"], ...]) -> list[Float[Tensor, "n *m"]]:
        """aᵀHb for the PAIRS of the frame's directions."""
        pairs = [pair for pair in PAIRS if max(pair) < len(frame)]
        scratch, *totals = (self.take() for _ in range(1 + len(pairs)))
        for total in totals:
            total.zero_()
        self.pushed.append([columns(direction) for direction in frame])
        for layer, V in enumerate(self.V):
            q = torch.mul(self.sin(layer), self.lambdas[layer], out=self.take())
            tangents = [V @ p for p in self.pushed[layer]]
            self.q.append(q)
            self.tangents.append(tangents)
            for i, tangent in enumerate(tangents):
                torch.mul(q, tangent, out=scratch)
                for total, (first, second) in zip(totals, pairs, strict=True):
                    if first == i:
                        total.addcmul_(scratch, tangents[second])
            if layer + 1 < self.depth:
                self.pushed.append([torch.mul(self.cos[layer], t, out=self.take()) for t in tangents])
        return [rows(-total.sum(-2)) for total in totals]

    def push_backward(self, block: Sequence[Tensor | None]) -> None:
        """From the second derivatives' cotangents to t̄, w and y."""
        count = len(self.tangents[0])
        twice, *G = (self.take() for _ in range(1 + count))
        p_bars: list[Tensor] | None = None
        for layer in reversed(range(self.depth)):
            tangents = self.tangents[layer]
            self.halves(block, tangents, G)
            self.w[layer] = self.summed(tangents, G)
            torch.mul(self.q[layer], -2.0, out=twice)
            t_bars = [torch.mul(twice, half, out=self.take()) for half in G]
            if p_bars is not None:
                self.y[layer] = self.summed(tangents, p_bars)
                for t_bar, p_bar in zip(t_bars, p_bars, strict=True):
                    t_bar.addcmul_(self.cos[layer], p_bar)
            self.t_bars.append(t_bars)
            if layer > 0:
                p_bars = [self.Vt[layer] @ t_bar for t_bar in t_bars]
        self.t_bars.reverse()

    def halves(self, block: Sequence[Tensor | None], tangents: list[Tensor], out: list[Tensor]) -> None:
        """out_a ← āa t_a + ½ Σ_b āb t_b: half the derivative of Σ āb t_a t_b with respect to every t_a."""
        for total in out:
            total.zero_()
        for (first, second), bar in zip(PAIRS, block, strict=False):
            if bar is None:
                continue
            wide = bar.unsqueeze(-2)
            if first == second:
                out[first].addcmul_(tangents[first], wide)
            else:
                out[first].addcmul_(tangents[second], wide, value=0.5)
                out[second].addcmul_(tangents[first], wide, value=0.5)

    def summed(self, one: list[Tensor], other: list[Tensor]) -> Float[Tensor, "*m width n"]:
        """Σ over the directions of the products."""
        total = torch.mul(one[0], other[0], out=self.take())
        for a, b in zip(one[1:], other[1:], strict=True):
            total.addcmul_(a, b)
        return total

    def reverse_backward(self, gradient: Float[Tensor, "*m 3 n"]) -> None:
        """From the gradient's cotangent to λ̄ and y."""
        self.lambda_bars.append(gradient)
        for layer, V in enumerate(self.V):
            delta_bar = V @ self.lambda_bars[layer]
            lambda_bar = torch.mul(delta_bar, self.cos[layer], out=self.take())
            w, y = self.w[layer], self.y[layer]
            if w is not None:
                lambda_bar.addcmul_(self.sin(layer), w, value=-1.0)
            self.lambda_bars.append(lambda_bar)
            delta_bar.mul_(self.lambdas[layer])
            self.y[layer] = delta_bar if y is None else y.add_(delta_bar)

    def forward_backward(self, value: Float[Tensor, "*m n"]) -> tuple[list[Tensor], list[Tensor]]:
        """From the value's cotangent, and all that came before, to the gradients of weights and biases.

        Cotangents come multiplied by ω, which the head, alone among the layers, has not.
        """
        head = (self.inputs[-1] @ value.unsqueeze(-1)).mT
        if self.order >= GRADIENT:
            head += self.lambda_bars[-1].sum(-1).unsqueeze(-2)
        weights, biases = [head / self.frequency], [value.sum(-1, keepdim=True) / self.frequency]
        a_bar = self.head.mT * value.unsqueeze(-2)
        for layer in reversed(range(self.depth)):
            w, y = self.w[layer], self.y[layer]
            if w is not None:
                a_bar.addcmul_(self.lambdas[layer], w, value=-1.0)
            z_bar = a_bar.mul_(self.cos[layer])
            if y is not None:
                z_bar.addcmul_(self.sin(layer), y, value=-1.0)
            weights.append(self.outer(layer, z_bar))
            biases.append(z_bar.sum(-1))
            if layer > 0:
                a_bar = self.Vt[layer] @ z_bar
        return weights[::-1], biases[::-1]

    def outer(self, layer: int, z_bar: Float[Tensor, "*m width n"]) -> Float[Tensor, "*m width inputs"]:
        """∂loss/∂V_l: the sum of the streams' outer products."""
        total = z_bar @ self.inputs[layer].mT
        if self.order >= GRADIENT:
            total += self.deltas[layer] @ self.lambda_bars[layer].mT
        if self.order >= TANGENT:
            for t_bar, p in zip(self.t_bars[layer], self.pushed[layer], strict=True):
                total += t_bar @ p.mT
        return total
