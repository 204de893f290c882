"""Which calculus suits a field: exact jets by the fastest way there is for it."""

from torch import nn

from weingarten.calculus.analytic import Analytic
from weingarten.calculus.autodiff import Autodiff
from weingarten.calculus.jet import Calculus
from weingarten.calculus.native import Native, suits
from weingarten.fields.ensemble import Ensemble
from weingarten.fields.siren import Siren


def exact(field: nn.Module) -> Calculus:
    """Exact jets: native ones of a float32 SIREN on a CPU, analytic ones of any other and of an ensemble.

    Of any other module, autograd's.
    """
    if isinstance(field, Siren) and suits(field):
        return Native(field)
    return Analytic(field) if isinstance(field, Siren | Ensemble) else Autodiff(field)
