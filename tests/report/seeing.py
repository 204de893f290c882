"""What a test sees of the view in 3D."""

import io

import numpy as np
from PIL import Image
from playwright.sync_api import Page

BACKGROUND = (251, 251, 249)
"""Of the page by day."""


def shown(page: Page, mode: str, mesh: str = "") -> None:
    """Wait until the canvas shows what was asked for."""
    page.wait_for_function(
        "([mode, mesh]) => { const own = document.getElementById('v-canvas').dataset.shown;"
        " return own && own.endsWith(mode) && own.includes(mesh); }",
        arg=[mode, mesh],
    )
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def pixels(page: Page) -> np.ndarray:
    """The canvas, without the line that shows the focus."""
    with Image.open(io.BytesIO(page.locator("#v-canvas").screenshot())) as image:
        return np.asarray(image.convert("RGB")).astype(int)[8:-8, 8:-8]


def drawn(image: np.ndarray) -> np.ndarray:
    """Where the mesh is."""
    return np.abs(image - BACKGROUND).max(axis=2) > 12


def saturation(image: np.ndarray) -> float:
    """Of what is drawn."""
    own = image[drawn(image)]
    return float((own.max(axis=1) - own.min(axis=1)).mean())


def brightness(colour: str) -> float:
    numbers = colour[colour.index("(") + 1 : -1].split(",")
    return sum(float(number) for number in numbers[:3]) / 3
