"""What a step is made of, before anything is drawn: which points, at which order, for which terms."""

from dataclasses import dataclass

from weingarten.scan.sample import DOMAINS
from weingarten.terms.term import Term


@dataclass(frozen=True)
class Span:
    """Points number `start` to `end` of a domain, taken at `order` for `terms`."""

    domain: str
    start: int
    end: int
    order: int
    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Outline:
    """All that decides which operations a step consists of.

    count: points of each domain. terms: of the loss. active: those of them with a weight above zero.
    progress: t, where a term or the calculus is another one at every step; else 0.
    """

    count: int
    terms: tuple[Term, ...]
    active: frozenset[Term]
    progress: float = 0.0

    def spans(self) -> list[Span]:
        """The domains, each cut where an active term's share of it ends."""
        found: list[Span] = []
        for domain in DOMAINS:
            ends = {term: term.taken(domain, self.count) for term in self.terms if domain in term.domains}
            start = 0
            for end in sorted({end for term, end in ends.items() if term in self.active}):
                reaching = [term for term in ends if ends[term] >= end]
                order = max(term.order for term in reaching if term in self.active)
                known = tuple(term for term in reaching if term.order <= order)
                found.append(Span(domain, start, end, order, known))
                start = end
        return found

    def counts(self) -> dict[Term, float]:
        """Of how many points each term gives its mean; NaN where some of them are not taken at its order."""
        spans, counts = self.spans(), {}
        for term in self.terms:
            seen = sum(span.end - span.start for span in spans if term in span.terms)
            counts[term] = float(seen) if seen == term.total(self.count) else float("nan")
        return counts
