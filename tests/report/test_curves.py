"""Loss and weight curves: bins, quartiles, files that are cut off, and which weights move."""

import numpy as np
import pytest

from weingarten.report import curves
from weingarten.report.curves import (
    all_curves,
    binned,
    loss_plots,
    mean_in_bins,
    middle,
    term_plots,
)


def columns(steps: int, weight: float = 1.0, end: float = 1.0) -> dict[str, np.ndarray]:
    t = end * np.arange(steps) / steps
    return {
        "progress": t,
        "loss": 100 * 10**-t,
        "eikonal": 0.1 + t,
        "weight_eikonal": weight * np.where(t < 0.5, 1.0, 0.0),
    }


def test_bins_hold_geometric_means_of_losses_and_means_of_weights():
    own = {
        "progress": np.array([0.0, 0.1, 0.6, 0.7]),
        "loss": np.array([1.0, 100.0, 0.0, 5.0]),
        "weight_x": np.array([2.0, 4.0, 0.0, 0.0]),
    }
    assert mean_in_bins(own, "loss", 2) == pytest.approx([10.0, 5.0])
    assert mean_in_bins(own, "weight_x", 2) == pytest.approx([3.0, 0.0])
    assert np.isnan(mean_in_bins(own, "loss", 20)[1])


def test_fits_of_different_lengths_meet_in_the_same_bins():
    made = binned("a", "#000000", [columns(30), columns(5000), columns(100, end=0.4)])
    assert made.columns["loss"].shape == (3, curves.BINS)
    assert made.terms == ["eikonal"]
    assert made.moves("eikonal")
    _, median, _ = middle(made.columns["loss"])
    expected = 100 * 10**-made.bins
    assert np.abs(np.log(median / expected)).max() < 0.1
    assert np.isfinite(median).all()


def test_a_constant_weight_does_not_move():
    still = columns(50) | {"weight_eikonal": np.full(50, 3.0)}
    made = binned("a", "#000000", [still])
    assert not made.moves("eikonal")
    assert "constant: eikonal 3" in loss_plots([made])[0].note


def test_plots_are_of_every_contender_and_every_term():
    every = [binned(name, "#040400", [columns(60), columns(80)]) for name in ("a", "b")]
    assert [plot.title for plot in loss_plots(every)] == ["a", "b"]
    assert [plot.title for plot in term_plots(every)] == ["eikonal"]
    assert all_curves([], ["a"]) == []
    assert loss_plots([]) == []
