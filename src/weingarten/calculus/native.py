"""Exact jets of a SIREN on a CPU, in float32: `weingarten.calculus.kernels` for torch's autograd.

The same formulas in torch's operations, for any type and device, are `weingarten.calculus.analytic`.
"""

from threading import Lock
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from weingarten.calculus import kernels
from weingarten.calculus.buffers import Buffers
from weingarten.calculus.jet import VALUE, Jet
from weingarten.calculus.kernels import COLUMNS, KEPT, PANEL, PASSING, STREAMS, Gradients, Weights
from weingarten.fields.siren import Siren


class Native:
    """The calculus of one SIREN: `Native(field)(points, order, angles)` is its jet.

    Differentiable once with respect to the field's weights; not with respect to the points.
    Raises TypeError for a field or points that are not float32 on a CPU.
    """

    def __init__(self, field: Siren) -> None:
        self.field = field
        self.parameters = (*field.weights, *field.biases)
        self.buffers = Buffers()
        self.lock = Lock()
        self.version: list[tuple[int, int]] = []
        self.weights = scaled(field)

    def __call__(
        self, points: Float[Tensor, "n 3"], order: int, angles: Float[Tensor, " n"] | None = None
    ) -> Jet:
        """See `weingarten.calculus.jet.Calculus`."""
        if self.parameters[0].dtype is not torch.float32 or points.dtype is not torch.float32:
            raise TypeError("native jets are of float32 on a CPU alone; Analytic has the others")
        if angles is None:
            angles = points.new_zeros(len(points))
        # within a Function's forward the grad mode is off, and needs_input_grad ignores no_grad
        trains = torch.is_grad_enabled() and any(weight.requires_grad for weight in self.parameters)
        return Jet(*_Jet.apply(points, order, angles, trains, self.buffers, self.present(), *self.parameters))

    def present(self) -> tuple[float, Weights]:
        """ω and the field's weights as they are now, worked out once for all pieces of a step.

        Writes to a weight through `.data` are not noticed.
        """
        with self.lock:
            version = [(weight.data_ptr(), weight._version) for weight in self.parameters]
            if self.version != version:
                self.version, self.weights = version, scaled(self.field)
            return self.field.frequency, self.weights


def suits(field: Siren) -> bool:
    """Whether Native can differentiate it."""
    return all(weight.dtype is torch.float32 and weight.device.type == "cpu" for weight in field.parameters())


def scaled(field: Siren) -> Weights:
    """The weights and biases of the sine layers times ω, and the head's as they are."""
    with torch.no_grad():
        first, *hidden, head = field.weights
        *biases, offset = field.biases
        width = len(first)
        stack = torch.cat(hidden).view(-1, width, width) if hidden else first.new_zeros(0, width, width)
        stack = field.frequency * stack
        arrays = (
            *(field.frequency * first, stack, stack.transpose(1, 2).contiguous()),
            *(field.frequency * torch.stack(biases), head.squeeze(0).clone(), offset.clone()),
        )
        return Weights(*(array.numpy() for array in arrays))


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
        present: tuple[float, Weights],
        *parameters: Tensor,
    ) -> tuple[Tensor, ...]:
        _, weights = present
        (layers, width), n = weights.biases.shape, len(points)
        tiles = -(-n // COLUMNS) if trains else min(n, 1)
        streams = STREAMS[order] if trains or order > VALUE else 1
        tape = buffers.take(points, tiles, streams, layers, width, COLUMNS)
        columns = points.t().contiguous()
        value, gradient, block = points.new_empty(n), points.new_empty(3, n), points.new_empty(3, n)
        frames = points.new_empty(6, n)
        passing = buffers.take(points, PASSING, -(-width // PANEL) * PANEL, COLUMNS)
        arrays = [array.numpy() for array in (tape, passing, value, gradient, frames, block)]
        kernels.forward(columns.numpy(), angles.contiguous().numpy(), weights, *arrays, order)
        buffers.give_back(passing)
        ctx.set_materialize_grads(False)
        if trains:
            ctx.kept = tape, columns, frames
            ctx.order, ctx.buffers, ctx.present = order, buffers, present
        else:
            buffers.give_back(tape)
        return (value, gradient.t(), *block)[: (1, 2, 5)[order]]

    @staticmethod
    def backward(ctx: Any, *bars: Tensor | None) -> tuple[Tensor | None, ...]:
        if ctx.kept is None:
            raise RuntimeError("a jet can be differentiated once: its buffers have been handed back")
        (tape, columns, frames), ctx.kept = ctx.kept, None
        (frequency, weights), buffers = ctx.present, ctx.buffers
        layers, width = weights.biases.shape
        n = columns.shape[1]
        value, gradient, *block = (*bars, None, None, None, None)[:5]
        # all is linear in the cotangents, so the ω of V = ωW is theirs from the beginning
        value_bar = columns.new_zeros(n) if value is None else frequency * value
        gradient_bar = (
            columns.new_zeros(3, n) if gradient is None else (frequency * gradient).t().contiguous()
        )
        zero = columns.new_zeros(n)
        block_bar = frequency * torch.stack([zero if bar is None else bar for bar in block])
        padded = -(-width // PANEL) * PANEL
        kept = buffers.take(columns, KEPT, layers, width, COLUMNS)
        passing = buffers.take(columns, PASSING, padded, COLUMNS)
        shapes = ((width, 3), (layers - 1, width, padded), (layers, width), (width,))
        out = [columns.new_zeros(shape) for shape in shapes]
        kernels.backward(
            columns.numpy(),
            weights,
            *(array.numpy() for array in (tape, frames, value_bar, gradient_bar, block_bar, kept, passing)),
            Gradients(*(array.numpy() for array in out)),
            ctx.order,
        )
        buffers.give_back(tape, kept, passing)
        first, hidden, biases, head = out
        offset = value_bar.sum().unsqueeze(0) / frequency
        return (
            *(None,) * 6,
            *(first, *hidden[:, :, :width], (head / frequency).unsqueeze(0)),
            *(*biases, offset),
        )
