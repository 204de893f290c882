"""A curriculum for the data terms: coarse shapes first, hard points later (Curriculum DeepSDF, Duan et al.
2020).

With y the distance that is known, 0 on the cloud, and ŷ = f:

    (1 + λ(t) sgn(y) sgn(y − ŷ)) · max(|y − ŷ| − ε(t), 0)

An error below the tolerance ε is none; errors towards the surface or beyond it, where y − ŷ has the sign of
y, are hard points and count 1 + λ, the others 1 − λ. The authors' tolerance and hardness, in epochs of
2,000, are schedules of t here, in unit lengths; the layers that they add to the network meanwhile are left
out. Their y is the true distance to the surface; here it is what free space tells, and nothing where it
tells nothing.
"""

from jaxtyping import Float
from torch import Tensor

from weingarten.calculus.jet import VALUE, Jet
from weingarten.scan.sample import OFF_SURFACE, SURFACE, Sample
from weingarten.schedules.schedule import Schedule
from weingarten.terms.free_space import residual as error_where_known
from weingarten.terms.term import Term

TOLERANCE = Schedule("step", ((0.0, 0.025), (0.1, 0.01), (0.3, 0.0025), (0.5, 0.0)))
HARDNESS = Schedule("step", ((0.0, 0.0), (0.1, 0.1), (0.3, 0.2), (0.5, 0.5)))
"""ε, unit lengths, and λ over t."""


def on_surface(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """w max(|f| − ε(t), 0), unit lengths, with w the weight of the point: 1 unless the cloud is noisy."""
    error = (jet.value.abs() - TOLERANCE(sample.progress)).clamp_min(0.0)
    return error if sample.weight is None else error * sample.weight


def off_surface(jet: Jet, sample: Sample) -> Float[Tensor, "n *m"]:
    """(1 + λ(t) sgn(d) sgn(d − f)) max(|f − d| − ε(t), 0) where the signed distance d is known, else 0."""
    beyond = (error_where_known(jet, sample) - TOLERANCE(sample.progress)).clamp_min(0.0)
    if sample.distance is None:
        return beyond
    known = sample.distance.nan_to_num()
    return beyond * (1.0 + HARDNESS(sample.progress) * known.sign() * (known - jet.value.detach()).sign())


CURRICULUM_SURFACE = Term("curriculum_surface", on_surface, (SURFACE,), VALUE, moving=True)
CURRICULUM_FREE_SPACE = Term("curriculum_free_space", off_surface, (OFF_SURFACE,), VALUE, moving=True)
