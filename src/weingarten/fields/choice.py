"""Fields by the name of what began them, as rows of methods have them: from width, depth, ω₀ and a generator.

All but `Siren` itself are a sphere's distance at first, or a multiple of it. What a field has no use for is
not read: ω₀ of a softplus network, or all of the sizes of a hash grid, which are its own.
"""

from collections.abc import Callable

import torch
from torch import nn

from weingarten.fields.hash_grid import HashGrid
from weingarten.fields.initialise import multi_frequency
from weingarten.fields.quadratic import QuadraticSiren
from weingarten.fields.siren import Siren
from weingarten.fields.softplus import SoftplusNet
from weingarten.fields.sphered import Sphered

DIGS_RADIUS, DIGS_SLOPE = 1.6 / 1.11, 0.111
"""Of the authors' first field, 0.1 (1.11 ‖x‖ − 1.6), unit lengths: a sphere of radius 1.44, past the faces of
the box but not its corners, nine times flatter than a distance."""

FieldMaker = Callable[[int, int, float, torch.Generator | None], nn.Module]


def sphere_siren(width: int, depth: int, frequency: float, generator: torch.Generator | None) -> Sphered:
    """DiGS's: multi-frequency geometric initialisation."""
    return Sphered(begun(width, depth, frequency, generator), DIGS_RADIUS, DIGS_SLOPE)


def quadratic_siren(width: int, depth: int, frequency: float, generator: torch.Generator | None) -> Sphered:
    """StEik's: the same, of quadratic layers."""
    inner = QuadraticSiren(begun(width, depth, frequency, generator), generator)
    return Sphered(inner, DIGS_RADIUS, DIGS_SLOPE)


def softplus_net(width: int, depth: int, frequency: float, generator: torch.Generator | None) -> SoftplusNet:
    """IGR's, here SAL's too."""
    return SoftplusNet(width, depth, generator=generator)


def hash_grid(width: int, depth: int, frequency: float, generator: torch.Generator | None) -> HashGrid:
    """Instant-NGP's encoding under one layer."""
    return HashGrid(generator=generator)


def begun(width: int, depth: int, frequency: float, generator: torch.Generator | None) -> Siren:
    """A SIREN after MFGI."""
    siren = Siren(width, depth, frequency, generator)
    multi_frequency(siren, generator)
    return siren
