"""The page in a real browser, offline: no error, nothing asked for, sorting tables, a 3D view that moves."""

import io
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser, Page

sys.path.insert(0, str(Path(__file__).parent))
import benchmark as tiny

from weingarten.report.page import Watcher, write_page

OF_THE_PICTURE = """
() => {
  const one = document.querySelector("details.part:last-of-type .shot[data-mesh='3'][data-mode=error] img");
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [one.naturalWidth, one.naturalHeight];
  const pen = canvas.getContext("2d");
  pen.drawImage(one, 0, 0);
  return [...pen.getImageData(0, 0, canvas.width, canvas.height).data];
}
"""
BACKGROUND = (251, 251, 249)
"""Of the page by day."""
NO_WEBGL = """
const context = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
  return kind === "webgl2" ? null : context.call(this, kind, ...more);
};
"""


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tiny.make(tmp_path_factory.mktemp("bench") / "tiny")
    write_page(folder, folder / "report.html", Watcher())
    return (folder / "report.html").as_uri()


@pytest.fixture
def page(browser: Browser, address: str) -> Iterator[Page]:
    """The page, open; afterwards: nothing went wrong in it and nothing but the file was asked for."""
    context = browser.new_context(viewport={"width": 1200, "height": 800}, offline=True)
    page = context.new_page()
    wrong: list[str] = []
    asked: list[str] = []
    page.on("console", lambda message: wrong.append(message.text) if message.type != "log" else None)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(address)
    yield page
    context.close()
    assert not [text for text in wrong if "GPU stall" not in text]
    assert {url for url in asked if not url.startswith("data:")} == {address}


def opened(page: Page, mode: str, name: str = tiny.SHIFTED, part_name: str = tiny.PARTS[0]) -> None:
    """Open the view in 3D by the picture of a contender."""
    part = page.locator("details.part", has=page.locator("h3", has_text=part_name))
    if part.get_attribute("open") is None:
        part.locator("summary").first.click()
    row = part.locator(".row", has=page.locator("h4", has_text=name))
    row.locator(f"button.shot[data-mode={mode}]").click()
    shown(page, mode)


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


def test_nothing_goes_wrong_in_either_scheme_or_on_a_phone(page: Page):
    assert page.title() == "tiny – benchmark report"
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        for width in (1200, 390):
            page.set_viewport_size({"width": width, "height": 800})
            assert page.evaluate("document.documentElement.scrollWidth") <= width
        ink, background = page.evaluate(
            "[getComputedStyle(document.body).color, getComputedStyle(document.body).backgroundColor]"
        )
        assert brightness(ink) - brightness(background) > 120 or scheme == "light"
        assert brightness(background) - brightness(ink) > 120 or scheme == "dark"


def brightness(colour: str) -> float:
    numbers = colour[colour.index("(") + 1 : -1].split(",")
    return sum(float(number) for number in numbers[:3]) / 3


def test_pictures_are_decoded(page: Page):
    page.locator("#unfold").click()
    sizes = page.evaluate(
        "Promise.all([...document.images].map(async (one) => {"
        " one.loading = 'eager'; await one.decode(); return one.naturalWidth; }))"
    )
    assert len(sizes) == 22
    assert min(sizes) > 100


def test_tables_sort_by_click_and_by_key(page: Page):
    article = page.locator("article.table", has=page.locator("h3", has_text="Means, protocol published-1"))
    table = article.locator("table")
    head = table.locator("thead th").nth(2)

    def column() -> list[float]:
        return table.evaluate(
            "(own) => [...own.tBodies[0].rows].filter((row) => !row.classList.contains('pinned'))"
            ".map((row) => Number(row.cells[2].dataset.value))"
        )

    before = column()
    assert len(before) == 3
    head.locator("button").click()
    assert column() == sorted(before)
    assert head.get_attribute("aria-sort") == "ascending"
    head.locator("button").focus()
    page.keyboard.press("Enter")
    assert column() == sorted(before, reverse=True)
    assert head.get_attribute("aria-sort") == "descending"
    assert table.locator("tbody tr").last.locator("th").inner_text() == "ceiling"
    table.locator("thead th").first.locator("button").click()
    names = table.locator("tbody tr th").all_inner_texts()
    assert names == [tiny.EXACTLY, tiny.POISSON, tiny.SHIFTED, "ceiling"]
    assert head.get_attribute("aria-sort") is None


@pytest.mark.parametrize("height", [500, 1400])
def test_the_view_begins_with_the_whole_part(page: Page, height: int):
    page.set_viewport_size({"width": 1000, "height": height})
    opened(page, "shaded", tiny.EXACTLY, tiny.PARTS[1])
    ball = drawn(pixels(page))
    assert ball.mean() > 0.05
    assert not ball[[0, -1]].any()
    assert not ball[:, [0, -1]].any()


def test_the_view_shows_the_mesh_and_turns_zooms_and_moves(page: Page):
    opened(page, "shaded")
    first = pixels(page)
    assert 0.05 < drawn(first).mean() < 0.8
    box = page.locator("#v-canvas").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 120, y + 40, steps=4)
    page.mouse.up()
    shown(page, "shaded")
    turned = pixels(page)
    assert (np.abs(turned - first).max(axis=2) > 12).mean() > 0.02
    page.mouse.wheel(0, -400)
    shown(page, "shaded")
    assert drawn(pixels(page)).mean() > 1.2 * drawn(turned).mean()
    page.keyboard.press("0")
    shown(page, "shaded")
    assert np.abs(pixels(page) - first).max() <= 2
    for _ in range(5):
        page.keyboard.press("Shift+ArrowLeft")
    shown(page, "shaded")
    moved = (
        np.nonzero(drawn(pixels(page)).any(axis=0))[0].mean() - np.nonzero(drawn(first).any(axis=0))[0].mean()
    )
    assert moved == pytest.approx(100, abs=6)
    page.locator("#v-reset").click()
    shown(page, "shaded")
    assert np.abs(pixels(page) - first).max() <= 2
    page.keyboard.press("Escape")
    assert not page.locator("#viewer").is_visible()


def test_colours_are_errors_on_demand_and_the_same_as_in_the_picture(page: Page):
    opened(page, "error")
    assert page.locator("#v-scale").is_visible()
    coloured = pixels(page)
    page.keyboard.press("e")
    shown(page, "missed")
    assert "distance to the mesh of shifted" in page.locator("#v-said").inner_text()
    missed = pixels(page)
    page.keyboard.press("e")
    shown(page, "shaded")
    plain = pixels(page)
    assert not page.locator("#v-scale").is_visible()
    assert saturation(coloured) > saturation(plain) + 15
    assert saturation(missed) > saturation(plain) + 15
    assert (np.abs(missed - coloured).max(axis=2) > 12).any()
    page.locator("label:has(input[value=error])").click()
    shown(page, "error")
    page.keyboard.press("p")
    shown(page, "error")
    picture = page.evaluate(OF_THE_PICTURE)
    rgba = np.array(picture).reshape(-1, 4)
    seen = rgba[rgba[:, 3] == 255, :3]
    view = coloured[drawn(coloured)]
    assert np.abs(seen.mean(axis=0) - view.mean(axis=0)).max() < 12


def test_parts_and_meshes_can_be_chosen(page: Page):
    page.locator("#open3d").click()
    shown(page, "shaded")
    assert page.locator("#v-said").inner_text().endswith(": the truth")
    assert page.locator("input[value=error]").is_disabled()
    truth = pixels(page)
    page.locator("#v-part").select_option(label=tiny.PARTS[0])
    shown(page, "1 -1 shaded")
    assert (np.abs(pixels(page) - truth).max(axis=2) > 12).mean() > 0.05
    page.locator("#v-mesh").select_option(label=tiny.ODD)
    shown(page, "1 1 shaded")
    assert "no mesh of this contender" in page.locator("#v-message").inner_text()
    assert not drawn(pixels(page))[:100].any()
    page.locator("#v-mesh").select_option(label=tiny.POISSON)
    shown(page, "1 2 shaded")
    assert page.locator("#v-message").is_hidden()
    assert drawn(pixels(page)).mean() > 0.05


def test_a_browser_without_webgl_is_told_so(page: Page):
    page.add_init_script(NO_WEBGL)
    page.reload()
    page.locator("#open3d").click()
    assert "needs WebGL2" in page.locator("#v-message").inner_text()
    page.locator("#v-part").select_option(label=tiny.PARTS[0])
    page.keyboard.press("Escape")


def test_a_link_to_a_part_unfolds_it(page: Page):
    part = page.locator("details.part").nth(1)
    assert part.get_attribute("open") is None
    page.locator(".index a").nth(1).click()
    part.locator(".gallery").wait_for(state="visible")
    page.locator("#fold").click()
    assert part.get_attribute("open") is None
