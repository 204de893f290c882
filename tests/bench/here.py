"""Fits in the tests' own process, which spares the start of another, judged by few samples."""

import pytest

from weingarten.bench import job
from weingarten.many.workers import Workers
from weingarten.metrics.exact import Exact
from weingarten.metrics.field_error import Field
from weingarten.metrics.published import Published


class Here(Workers):
    """Fits in this process."""

    def perform(self, batches, watcher) -> None:
        for batch in batches:
            watcher.begin(batch)
            job.perform(batch)
            watcher.end(batch)


def judge_by_few(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is judged in this process is judged by fewer samples."""
    monkeypatch.setattr(job, "PUBLISHED", Published(samples=5000))
    monkeypatch.setattr(job, "EXACT", Exact(samples=5000, edge_samples=500))
    monkeypatch.setattr(job, "FIELD", Field(samples=2000))
