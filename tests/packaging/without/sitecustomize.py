"""Python imports this when it starts: the modules named in WITHOUT are then as if they were not installed."""

import os
import sys
from importlib.machinery import PathFinder

NAMES = frozenset(filter(None, os.environ.get("WITHOUT", "").split(",")))


class Without(PathFinder):
    """Finds what Python finds, but for NAMES and what is in them."""

    @classmethod
    def find_spec(cls, fullname, path=None, target=None):
        """None for what is not there."""
        return None if fullname.partition(".")[0] in NAMES else super().find_spec(fullname, path, target)


sys.meta_path[sys.meta_path.index(PathFinder)] = Without
