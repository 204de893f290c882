"""The page about one fit in a real browser, offline."""

import sys
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page

sys.path.insert(0, str(Path(__file__).parents[1]))
import one_run
from seeing import brightness, drawn, pixels, saturation, shown

from weingarten.report.run.page import write_run_page


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = one_run.make(tmp_path_factory.mktemp("runs") / "part")
    write_run_page(folder, folder / "report.html")
    return (folder / "report.html").as_uri()


def test_nothing_goes_wrong_in_either_scheme_or_on_a_phone(page: Page):
    assert page.title().endswith(" – fit summary")
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        for width in (1200, 420, 360):
            page.set_viewport_size({"width": width, "height": 800})
            assert page.evaluate("document.documentElement.scrollWidth") <= width
        ink, background = page.evaluate(
            "(() => { const own = getComputedStyle(document.querySelector('.verdict strong'));"
            " return [own.color, getComputedStyle(document.body).backgroundColor]; })()"
        )
        assert abs(brightness(ink) - brightness(background)) > 80


def test_pictures_are_decoded(page: Page):
    sizes = page.evaluate(
        "Promise.all([...document.images].map(async (one) => {"
        " await one.decode(); return one.naturalWidth; }))"
    )
    assert sizes == [600, 600, 460, 460, 460, 460]


def test_a_picture_opens_the_view_in_3d_from_its_side_and_in_its_colours(page: Page):
    page.locator("#deviation .shot").first.click()
    shown(page, "error")
    front = pixels(page)
    assert page.locator("#v-scale").is_visible()
    assert page.locator("#v-part").is_hidden()
    assert "deviation of the points" in page.locator("#v-said").inner_text()
    page.locator("label:has(input[value=shaded])").click()
    shown(page, "shaded")
    assert saturation(front) > saturation(pixels(page)) + 15
    page.keyboard.press("Escape")
    page.locator("#deviation .shot").last.click()
    shown(page, "error")
    back = pixels(page)
    assert drawn(back).mean() == pytest.approx(drawn(front).mean(), rel=0.02)
    assert (np.abs(back - front).max(axis=2) > 12).mean() > 0.05


def test_the_command_can_be_taken_with_one_click(page: Page):
    page.locator(".command").click()
    chosen = page.evaluate("getSelection().toString()")
    assert chosen.startswith("weingarten fit ")
    assert chosen.endswith("-o part.stl")


class TestWithoutMesh:
    """A run that has none: nothing to open in 3D, and nothing that goes wrong for want of it."""

    @pytest.fixture
    def address(self, tmp_path: Path) -> str:
        folder = one_run.without_mesh(tmp_path / "part")
        write_run_page(folder, folder / "report.html")
        return (folder / "report.html").as_uri()

    def test_the_console_is_clean(self, page: Page):
        assert "This run has no mesh" in page.locator(".verdict").inner_text()
        assert page.locator("#open3d").count() == 0
