"""Every method is a row: which terms, under which schedules, differentiated how, and where it comes from."""

from dataclasses import replace

from weingarten.calculus.choice import Differences, central_gradients, exact
from weingarten.calculus.finite_difference import CROSS
from weingarten.errors import OptionError
from weingarten.fields.choice import FieldMaker, hash_grid, quadratic_siren, softplus_net, sphere_siren
from weingarten.fields.siren import Siren
from weingarten.method import Differentiation, Method
from weingarten.scan.knowledge import signs_and_normals, signs_of_free_space, unsigned_distances
from weingarten.scan.preparation import AS_SCANNED
from weingarten.scan.sample import OFF_SURFACE, SURFACE
from weingarten.schedules.schedule import SCHEDULES, Schedule, constant
from weingarten.schedules.weight import Weight
from weingarten.terms.curriculum import CURRICULUM_FREE_SPACE, CURRICULUM_SURFACE
from weingarten.terms.dirichlet import DIRICHLET
from weingarten.terms.divergence import DIVERGENCE_CLAMPED
from weingarten.terms.eikonal import EIKONAL, EIKONAL_ABSOLUTE, EIKONAL_OF_NORM
from weingarten.terms.free_space import FREE_SPACE
from weingarten.terms.gaussian_curvature import DOUBLE_TROUGH, GAUSSIAN_CURVATURE
from weingarten.terms.normal_divergence import NORMAL_DIVERGENCE
from weingarten.terms.normals import NORMALS
from weingarten.terms.off_diagonal_weingarten import FRAME_FREE_WEINGARTEN, OFF_DIAGONAL_WEINGARTEN
from weingarten.terms.off_surface import OFF_SURFACE_TERM
from weingarten.terms.principal_curvature import SMALLER_CURVATURE
from weingarten.terms.sign_agnostic import SIGN_AGNOSTIC
from weingarten.terms.singular_hessian import SINGULAR_HESSIAN
from weingarten.terms.term import Term

RECIPE_EIKONAL = replace(EIKONAL_ABSOLUTE, shares=(0.5, 1.0))
FIRST_ORDER: dict[Term, Weight] = {
    DIRICHLET: constant(7000.0),
    OFF_SURFACE_TERM: constant(100.0),
    FREE_SPACE: constant(1000.0),
    RECIPE_EIKONAL: constant(50.0),
}
"""Of the recipe: the dear terms on fewer points, for the same mean; its noise is not what limits a fit."""

CURRICULUM: dict[Term, Weight] = {
    CURRICULUM_SURFACE: constant(7000.0),
    OFF_SURFACE_TERM: constant(100.0),
    CURRICULUM_FREE_SPACE: constant(1000.0),
    RECIPE_EIKONAL: constant(50.0),
}
"""The same with the curriculum's data terms."""

ORIENTED: dict[Term, Weight] = {**FIRST_ORDER, replace(NORMALS, shares=(0.5,)): constant(30.0)}
"""The same with the normals' directions, at the points whose gradient the eikonal term has asked for."""


def siren_loss(eikonal: Term, data: float = 7000.0, off_surface: float = 600.0) -> dict[Term, Weight]:
    """SIREN's terms without normals; what came after it differs in weights and in the eikonal term."""
    return {
        DIRICHLET: constant(data),
        OFF_SURFACE_TERM: constant(off_surface),
        eikonal: constant(50.0),
    }


SIREN_EIKONAL = replace(EIKONAL_ABSOLUTE, domains=(SURFACE, OFF_SURFACE))
PAPER_FIRST_ORDER, CODE_FIRST_ORDER = siren_loss(EIKONAL), siren_loss(EIKONAL_ABSOLUTE)
"""Of arXiv 2511.03147 as written, and of the codes that it comes from."""

DIGS = siren_loss(SIREN_EIKONAL, data=3000.0, off_surface=100.0)
STEIK = siren_loss(SIREN_EIKONAL, data=5000.0, off_surface=100.0)
"""Of SIREN and DiGS, and of StEik, as it was run on ShapeNet."""

NSH_FIRST_ORDER = siren_loss(replace(EIKONAL_ABSOLUTE, domains=(SURFACE,)))
FD_FIRST_ORDER = siren_loss(SIREN_EIKONAL)
"""Of Neural-Singular-Hessian and of arXiv 2511.08980."""

EARLY = Schedule("quintic", ((0.0, 1.0), (0.1, 1.0), (0.3, 0.0)))
"""The recipe's: gone at 30 % of the fit."""


GAUSSIAN_WEIGHT, STENCIL_WEIGHT = 0.01, 0.1
"""Greatest weights of Gaussian curvature in the recipe, exact and by differences. |K| is large where the
young field's gradient is small; these few points steer a fit, and ten and thirty times as much ruined it."""


def recipe(name: str, term: Term, weight: float, calculus: Differentiation, source: str) -> Method:
    """Our recipe with some curvature term: signs from free space, the term on few points and early."""
    few = replace(term, shares=(0.125,))
    terms = {**FIRST_ORDER, few: EARLY.peaking(weight)}
    return Method(name, terms, calculus, source, few, signs_of_free_space, AS_SCANNED)


def published(
    name: str,
    first_order: dict[Term, Weight],
    term: Term,
    weight: Weight,
    calculus: Differentiation,
    source: str,
    field: FieldMaker = Siren,
) -> Method:
    """A method as its authors have it: nothing known but the points, the term on all of its points."""
    return Method(name, {**first_order, term: weight}, calculus, source, term, field=field, made_for="paper")


ODW, FRAME_FREE, GAUSSIAN = OFF_DIAGONAL_WEINGARTEN, FRAME_FREE_WEINGARTEN, GAUSSIAN_CURVATURE
FLATCAD, CROSS_WIDE, CROSS_NARROW = Differences(), Differences(CROSS, constant(0.1)), Differences(CROSS)
"""The stencils of FlatCAD, and of arXiv 2511.08980 for Gaussian curvature and for rank deficiency."""

QUINTIC, LINEAR, TEN = SCHEDULES["quintic"], SCHEDULES["linear"].peaking(5.0), constant(10.0)
ANNEALED = Schedule("linear", ((0.0, 1.5), (0.2, 1.5), (0.4, 0.0005), (1.0, 0.00005)))
"""Weights: this paper's, NeurCADRecon's, FlatCAD's and Neural-Singular-Hessian's. The codes of the second and
the last halve the term, of which only the near points' half is on: the half is in these weights."""

VANISHING = Schedule("linear", ((0.0, 100.0), (0.2, 100.0), (0.4, 0.0)))
"""Of the divergence and of the normal divergence."""

COARSE_TO_FINE = Schedule("linear", tuple((0.06 * level, 0.275 * 0.5**level) for level in range(6)))
GRID_STENCIL = Differences(step=COARSE_TO_FINE, inner=central_gradients)
"""From a cell of the coarsest grid to one of the finest, which it reaches when the curvature term is gone."""

FEW_ODW = replace(ODW, shares=(0.125,))
IGR_RATES, SAL_RATES = {"muon": 1.5e-2, "adam": 5e-3}, {"muon": 1.5e-2, "adam": 5e-4}
GRID_RATES, QUADRATIC_RATES = {"muon": 2.5e-3, "adam": 1e-3}, {"muon": 5e-5}
"""Learning rates of fields other than a plain SIREN: with Muon found on a bundled part, with Adam those of
IGR, of SAL and of Neuralangelo. The quadratic layers' is StEik's own, with either."""

IGR_EIKONAL = replace(EIKONAL_OF_NORM, shares=(0.125, 1.0))
"""An eighth of the points in the box, as its authors have them."""

IGR_TERMS: dict[Term, Weight] = {DIRICHLET: constant(1.0), IGR_EIKONAL: constant(0.1)}
SAL_TERMS: dict[Term, Weight] = {SIGN_AGNOSTIC: constant(1.0)}

METHODS = {
    method.name: method
    for method in (
        recipe("odw", ODW, 3.0, exact, "arXiv 2511.03147"),
        replace(
            recipe("odw-oriented", ODW, 3.0, exact, "ours: normals that free space orients"),
            terms={**ORIENTED, FEW_ODW: EARLY.peaking(3.0)},
            knowledge=signs_and_normals,
        ),
        recipe("odw-fd", ODW, 3.0, FLATCAD, "arXiv 2506.16627 (FlatCAD-FD)"),
        recipe("frame-free", FRAME_FREE, 3.0, exact, "ours: the mean over all frames"),
        recipe("smaller-curvature", SMALLER_CURVATURE, 3.0, exact, "ours: flat in one direction"),
        recipe("gaussian", GAUSSIAN, GAUSSIAN_WEIGHT, exact, "arXiv 2404.13420 (NeurCADRecon)"),
        recipe("gaussian-fd", GAUSSIAN, STENCIL_WEIGHT, CROSS_WIDE, "arXiv 2511.08980"),
        recipe("double-trough", DOUBLE_TROUGH, GAUSSIAN_WEIGHT, exact, "arXiv 2404.13420 (NeurCADRecon)"),
        recipe("singular-hessian", SINGULAR_HESSIAN, 1.5, exact, "arXiv 2309.01793"),
        recipe("divergence", DIVERGENCE_CLAMPED, 30.0, exact, "arXiv 2106.10811 (DiGS)"),
        recipe("normal-divergence", NORMAL_DIVERGENCE, 3.0, exact, "arXiv 2305.18414 (StEik)"),
        Method(
            "curriculum",
            {**CURRICULUM, FEW_ODW: EARLY.peaking(3.0)},
            exact,
            "arXiv 2003.08593 (Curriculum DeepSDF)",
            FEW_ODW,
            signs_of_free_space,
            AS_SCANNED,
        ),
        replace(
            recipe("hash-grid", ODW, 3.0, GRID_STENCIL, "Instant-NGP's field, Neuralangelo's stencil"),
            field=hash_grid,
            rates=GRID_RATES,
        ),
        Method(
            "igr",
            IGR_TERMS,
            exact,
            "arXiv 2002.10099, without normals",
            scheduled=None,
            field=softplus_net,
            rates=IGR_RATES,
        ),
        Method(
            "sal",
            SAL_TERMS,
            exact,
            "arXiv 1911.10414",
            None,
            unsigned_distances,
            field=softplus_net,
            rates=SAL_RATES,
        ),
        published("digs", DIGS, DIVERGENCE_CLAMPED, VANISHING, exact, "arXiv 2106.10811", sphere_siren),
        replace(
            published(
                "steik", STEIK, NORMAL_DIVERGENCE, VANISHING, exact, "arXiv 2305.18414", quadratic_siren
            ),
            rates=QUADRATIC_RATES,
        ),
        published(
            "neural-singular-hessian",
            NSH_FIRST_ORDER,
            SINGULAR_HESSIAN,
            ANNEALED,
            exact,
            "arXiv 2309.01793",
        ),
        Method("siren", DIGS, exact, "arXiv 2006.09661, without normals", None, made_for="paper"),
        published("odw-paper", PAPER_FIRST_ORDER, ODW, QUINTIC, exact, "arXiv 2511.03147"),
        published("odw-paper-fd", PAPER_FIRST_ORDER, ODW, QUINTIC, FLATCAD, "arXiv 2511.03147"),
        published("flatcad", CODE_FIRST_ORDER, ODW, TEN, exact, "arXiv 2506.16627"),
        published("flatcad-fd", CODE_FIRST_ORDER, ODW, TEN, FLATCAD, "arXiv 2506.16627"),
        published("neurcadrecon", CODE_FIRST_ORDER, GAUSSIAN_CURVATURE, LINEAR, exact, "arXiv 2404.13420"),
        published("neurcadrecon-trough", CODE_FIRST_ORDER, DOUBLE_TROUGH, LINEAR, exact, "arXiv 2404.13420"),
        published(
            "neurcadrecon-fd",
            FD_FIRST_ORDER,
            GAUSSIAN_CURVATURE,
            constant(1.0),
            CROSS_WIDE,
            "arXiv 2511.08980",
        ),
        published("nsh-fd", NSH_FIRST_ORDER, GAUSSIAN_CURVATURE, ANNEALED, CROSS_NARROW, "arXiv 2511.08980"),
    )
}
"""Our recipe with one curvature term after another, then methods as their authors have them."""


def method_named(name: str) -> Method:
    """A row of METHODS; OptionError lists what there is."""
    if name not in METHODS:
        raise OptionError(f"There is no method {name!r}; choose one of {', '.join(METHODS)}.")
    return METHODS[name]
