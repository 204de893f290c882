"""First weights of a SIREN that make it a sphere's distance, after `weingarten.fields.sphered.Sphered`.

DiGS (Ben-Shabat et al. 2022). Times ω₀, every sine layer but the last keeps lengths while its arguments are
small, so that ‖a‖ ≈ ‖x‖ in front of the last; there, and in the head,

    z = ½π (a + 1),  sin z = cos ½πa,   n − Σ sin z = Σ (1 − cos ½πa) ≈ ⅛ π² ‖x‖²,

whose root is the distance from the origin. The authors' layers keep lengths on average alone, by independent
draws; these are orthogonal. Released re-implementations leave the root out.
"""

import math

import torch
from jaxtyping import Float
from torch import Tensor, nn

from weingarten.fields.siren import Siren, uniform

LOW = 0.25
"""Share of the first layer's units that are heard at first, in the multi-frequency initialisation."""

LINKS = 0.0005
"""Standard deviation of the second layer's weights, but the quarter's own, times the root of the width."""

JITTER = 0.001
"""Standard deviation about ½π of the last sine layer's weights, before they are divided by ω₀."""


def geometric(siren: Siren, generator: torch.Generator | None = None) -> None:
    """Geometric initialisation, in place. Raises ValueError for a field of fewer than two sine layers.

    Orthogonal layers and no biases; in the last sine layer ½π on the diagonal and in the biases, with JITTER;
    the head −1 with bias n, the width.
    """
    check_depth(siren, 2)
    for weight, bias in zip(list(siren.weights)[:-2], list(siren.biases)[:-2], strict=True):
        put(weight, orthogonal(tuple(weight.shape), generator) / siren.frequency)
        put(bias, torch.zeros_like(bias))
    width = siren.weights[-1].shape[1]
    half, one = 0.5 * math.pi, JITTER * torch.randn(width, width + 1, generator=generator)
    put(siren.weights[-2], (half * torch.eye(width) + one[:, :-1]) / siren.frequency)
    put(siren.biases[-2], (half + one[:, -1]) / siren.frequency)
    put(siren.weights[-1], -torch.ones(1, width))
    put(siren.biases[-1], torch.full((1,), float(width)))


def multi_frequency(siren: Siren, generator: torch.Generator | None = None) -> None:
    """Multi-frequency geometric initialisation (MFGI), in place: high frequencies are there, but unheard.

    A quarter of the first layer's units begins as in `geometric`, the others with up to ω₀ radians a unit
    length along each axis. The second layer's weights are orthogonal / ω₀ within the quarter and small, by
    LINKS, everywhere else. The authors' quarter has frequencies of up to one period, at which sines are no
    longer lines and the sphere is less of one.
    Raises ValueError for a field of fewer than three sine layers.
    """
    check_depth(siren, 3)
    geometric(siren, generator)
    width, frequency = len(siren.weights[0]), siren.frequency
    low = max(3, int(LOW * width))
    heard = orthogonal((low, 3), generator) / frequency
    put(siren.weights[0], torch.cat([heard, uniform((width - low, 3), 1.0, generator)]))
    links = LINKS * uniform((width, width), math.sqrt(3.0 / width), generator)
    links[:low, :low] = orthogonal((low, low), generator) / frequency
    put(siren.weights[1], links)


def check_depth(siren: Siren, least: int) -> None:
    """Raise ValueError unless there are so many sine layers."""
    if len(siren.weights) - 1 < least:
        raise ValueError(f"this initialisation needs {least} sine layers; there are {len(siren.weights) - 1}")


def orthogonal(shape: tuple[int, ...], generator: torch.Generator | None) -> Float[Tensor, "out into"]:
    """A random matrix that keeps lengths."""
    return nn.init.orthogonal_(torch.empty(shape), generator=generator)


def put(parameter: Tensor, values: Tensor) -> None:
    """Overwrite a parameter."""
    with torch.no_grad():
        parameter.copy_(values)
