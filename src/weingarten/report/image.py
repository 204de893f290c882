"""Pictures that stand in the page as data."""

import base64
import io

from PIL import Image

QUALITIES = (80, 60, 40)
LARGE = 18_000
"""Bytes; a larger picture, of a rough surface, is made again with the next quality."""


def data_uri(image: Image.Image, large: int = LARGE) -> str:
    """The picture as WebP in a data URI, of less quality where it would be larger than so many bytes."""
    content = b""
    for quality in QUALITIES:
        stream = io.BytesIO()
        image.save(stream, "WEBP", quality=quality, method=5)
        content = stream.getvalue()
        if len(content) <= large:
            break
    return "data:image/webp;base64," + base64.b64encode(content).decode("ascii")


def small(image: Image.Image, width: int) -> Image.Image:
    """The picture made smaller, to that width."""
    height = max(1, round(image.height * width / image.width))
    return image.resize((width, height), Image.Resampling.LANCZOS)
