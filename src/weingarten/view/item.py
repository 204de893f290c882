"""What the page is sent: a few plain values and some bytes, in one.

Before deflation (RFC 1950): the length of the values in four bytes, lowest first; the values as JSON; the
bytes.
"""

import json
import zlib
from typing import Any

QUICK = 6


def item(values: dict[str, Any], content: bytes = b"") -> bytes:
    """Values and bytes, deflated."""
    said = json.dumps(values, allow_nan=False).encode()
    return zlib.compress(len(said).to_bytes(4, "little") + said + content, QUICK)


def opened(packed: bytes) -> tuple[dict[str, Any], bytes]:
    """The inverse."""
    content = zlib.decompress(packed)
    end = 4 + int.from_bytes(content[:4], "little")
    return json.loads(content[4:end]), content[end:]
