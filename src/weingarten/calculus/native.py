"""Exact jets of a SIREN on a CPU, in float32: `weingarten.calculus.kernels` for torch's autograd.

The same formulas in torch's operations, for any type and device, are `weingarten.calculus.analytic`.
"""

from threading import Lock
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from weingarten.calculus import kernels
from weingarten.calculus.analytic import Analytic
from weingarten.calculus.buffers import Buffers
from weingarten.calculus.evaluation import Bars, Evaluation, Taped
from weingarten.calculus.jet import TANGENT, TENSORS, VALUE, Jet
from weingarten.calculus.kernels import COLUMNS, KEPT, PANEL, PASSING, STREAMS, Gradients, Weights
from weingarten.fields.siren import Siren
from weingarten.machine_code import is_kept


class Native:
    """The calculus of one SIREN: `Native(field)(points, order, angles)` is its jet.

    That of order HESSIAN is Analytic's: there is machine code up to the tangent block. Differentiable once
    with respect to the field's weights; not with respect to the points.
    Raises TypeError for a field or points that are not float32 on a CPU.
    """

    def __init__(self, field: Siren) -> None:
        self.field = field
        self.analytic = Analytic(field)
        self.parameters = (*field.weights, *field.biases)
        self.buffers = Buffers()
        self.lock = Lock()
        self.version: list[tuple[int, int]] = []
        self.weights = scaled(field)

    def __call__(
        self, points: Float[Tensor, "n 3"], order: int, angles: Float[Tensor, " n"] | None = None
    ) -> Jet:
        """See `weingarten.calculus.jet.Calculus`."""
        if order > TANGENT:
            return self.analytic(points, order, angles)
        if angles is None:
            angles = points.new_zeros(len(points))
        # within a Function's forward the grad mode is off, and needs_input_grad ignores no_grad
        trains = torch.is_grad_enabled() and any(weight.requires_grad for weight in self.parameters)
        passes = self.passes(points, order, angles, trains)
        return Jet(*_Jet.apply(passes, *self.parameters))

    def begin(self, points: Float[Tensor, "n 3"], order: int, angles: Float[Tensor, " n"]) -> Evaluation:
        """See `weingarten.calculus.evaluation.Staged`."""
        if order > TANGENT:
            return Taped(self.analytic, list(self.parameters), points, order, angles)
        return self.passes(points, order, angles, True)

    def passes(
        self, points: Float[Tensor, "n 3"], order: int, angles: Float[Tensor, " n"], trains: bool
    ) -> "Passes":
        """Those over some points; only where it trains can they be gone back."""
        if self.parameters[0].dtype is not torch.float32 or points.dtype is not torch.float32:
            raise TypeError("native jets are of float32 on a CPU alone; Analytic has the others")
        return Passes(points, order, angles, trains, self.buffers, self.present())

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


def is_compiled() -> bool:
    """Whether an earlier process has left the machine code; else the first pass takes ten seconds or more."""
    return is_kept(kernels.backward)


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


class Passes:
    """One jet by machine code, there and back: an Evaluation whose large halves are nothing else.

    What trains can be gone back, once; the arrays are those of `weingarten.calculus.kernels`.
    """

    def __init__(
        self,
        points: Float[Tensor, "n 3"],
        order: int,
        angles: Float[Tensor, " n"],
        trains: bool,
        buffers: Buffers,
        present: tuple[float, Weights],
    ) -> None:
        self.order, self.trains, self.buffers = order, trains, buffers
        self.frequency, self.weights = present
        (layers, width), n = self.weights.biases.shape, len(points)
        tiles = -(-n // COLUMNS) if trains else min(n, 1)
        streams = STREAMS[order] if trains or order > VALUE else 1
        self.columns, self.angles = points.t().contiguous(), angles.contiguous()
        self.results = points.new_empty(13, n).split([1, 3, 6, 3])
        self.tape = buffers.take(points, tiles, streams, layers, width, COLUMNS)
        self.passing = buffers.take(points, PASSING, padded(width), COLUMNS)

    def forward(self) -> None:
        """See Evaluation."""
        value, gradient, frames, block = (result.numpy() for result in self.results)
        room = self.tape.numpy(), self.passing.numpy()
        points, angles = self.columns.numpy(), self.angles.numpy()
        kernels.forward(points, angles, self.weights, *room, value[0], gradient, frames, block, self.order)
        if not self.trains:
            self.buffers.give_back(self.tape, self.passing)

    def jet(self) -> Jet:
        """See Evaluation."""
        value, gradient, _, block = self.results
        return Jet(*(value[0], gradient.t(), *block)[: TENSORS[self.order]])

    def pull(self, bars: Bars) -> None:
        """See Evaluation. Linear in the cotangents, so the ω of V = ωW is theirs from the first."""
        rows = self.columns.new_zeros(7, self.columns.shape[1])
        value, gradient, *block = (*bars, None, None, None, None)[:5]
        places = rows[0], rows[1:4].t(), rows[4], rows[5], rows[6]
        for place, bar in zip(places, (value, gradient, *block), strict=True):
            if bar is not None:
                torch.mul(bar, self.frequency, out=place)
        self.bars = rows.split([1, 3, 3])
        layers, width = self.weights.biases.shape
        self.kept = self.buffers.take(rows, KEPT, layers, width, COLUMNS)
        self.sums = rows.new_empty(width * (4 + layers) + (layers - 1) * width * width + 1)
        self.parts = parts_of(self.sums, layers, width)
        whole = padded(width) == width
        self.hidden = self.parts[1] if whole else rows.new_empty(layers - 1, width, padded(width))

    def backward(self) -> None:
        """See Evaluation."""
        value, gradient, block = (bar.numpy() for bar in self.bars)
        arrays = self.columns.numpy(), self.weights, self.tape.numpy(), self.results[2].numpy()
        room = self.kept.numpy(), self.passing.numpy()
        first, _, head, biases, _ = self.parts
        out = Gradients(*(array.numpy() for array in (first, self.hidden, biases, head)))
        kernels.backward(*arrays, value[0], gradient, block, *room, out, self.order)
        self.buffers.give_back(self.tape, self.passing, self.kept)

    def gradient(self) -> Float[Tensor, " w"]:
        """See Evaluation."""
        _, hidden, head, _, offset = self.parts
        if self.hidden is not hidden:
            hidden.copy_(self.hidden[:, :, : len(head)])
        head.div_(self.frequency)
        torch.div(self.bars[0].sum(), self.frequency, out=offset)
        return self.sums


def parts_of(weights: Float[Tensor, " w"], layers: int, width: int) -> tuple[Tensor, ...]:
    """Views of first, hidden, head, biases and offset, which lie in the order of a SIREN's parameters."""
    sizes = [3 * width, (layers - 1) * width * width, width, layers * width, 1]
    first, hidden, head, biases, offset = weights.split(sizes)
    square = hidden.view(layers - 1, width, width)
    return first.view(width, 3), square, head, biases.view(layers, width), offset[0]


def padded(width: int) -> int:
    """The width in whole panels."""
    return -(-width // PANEL) * PANEL


class _Jet(torch.autograd.Function):
    """Passes as torch's autograd wants them."""

    @staticmethod
    def forward(ctx: Any, passes: Passes, *parameters: Tensor) -> tuple[Tensor, ...]:
        ctx.set_materialize_grads(False)
        passes.forward()
        ctx.passes = passes if passes.trains else None
        ctx.shapes = [parameter.shape for parameter in parameters]
        return passes.jet().tensors

    @staticmethod
    def backward(ctx: Any, *bars: Tensor | None) -> tuple[Tensor | None, ...]:
        if ctx.passes is None:
            raise RuntimeError("a jet can be differentiated once: its buffers have been handed back")
        passes, ctx.passes = ctx.passes, None
        passes.pull(bars)
        passes.backward()
        gradients = passes.gradient().split([shape.numel() for shape in ctx.shapes])
        return None, *(own.view(shape) for own, shape in zip(gradients, ctx.shapes, strict=True))
