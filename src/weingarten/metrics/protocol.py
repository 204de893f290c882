"""Named, versioned ways of comparing with the truth; a figure without its protocol means nothing.

`exact-1`, the default, and `published-1`, that of the field's tables, compare a mesh; `field-1` compares a
field. Lengths are in unit-cube lengths: the box's centre at the origin, its longest side 1. Any change that
moves a figure beyond its sampling noise gets a new number.
"""

from weingarten.metrics.exact import EXACT
from weingarten.metrics.field_error import FIELD
from weingarten.metrics.published import PUBLISHED

PROTOCOLS = {"published": PUBLISHED, "exact": EXACT}
"""Those that compare a mesh, by the name that the command knows them by."""

__all__ = ["EXACT", "FIELD", "PROTOCOLS", "PUBLISHED"]
