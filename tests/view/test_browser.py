"""The view in a real browser: what is chosen is shown, nothing goes wrong, and nobody else is asked."""

import io
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import Browser, Page, expect

sys.path.insert(0, str(Path(__file__).parent))
from exhibits import Known, ball, mesh

import weingarten as wg
from weingarten import reconstruction
from weingarten.fit.loop import Record
from weingarten.observer import Observer
from weingarten.samples.parts import sample_part
from weingarten.view import page as pages
from weingarten.view.exhibit import Exhibit
from weingarten.view.page import write_page
from weingarten.view.run import Run
from weingarten.view.server import Server
from weingarten.view.subject import Look, Still

BACKGROUND = (251, 251, 249)
"""Of the page by day."""
NO_WEBGL = """
const context = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
  return kind === "webgl2" ? null : context.call(this, kind, ...more);
};
"""


@contextmanager
def served(exhibit: Exhibit) -> Iterator[str]:
    """The address of a server, for as long as it is wanted."""
    with Server(exhibit, "127.0.0.1", 0) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield server.address
        server.shutdown()
        thread.join()


@contextmanager
def shown(browser: Browser, address: str, script: str = "", offline: bool = False) -> Iterator[Page]:
    """The page, open; afterwards: nothing went wrong in it and nothing but its address was asked."""
    context = browser.new_context(viewport={"width": 900, "height": 560}, offline=offline)
    context.set_default_timeout(120_000)
    page = context.new_page()
    wrong: list[str] = []
    asked: list[str] = []
    page.on("console", lambda message: wrong.append(message.text) if message.type != "log" else None)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    if script:
        page.add_init_script(script)
    page.goto(address)
    yield page
    context.close()
    assert not [text for text in wrong if "GPU stall" not in text]
    assert all(url.startswith((address, "data:")) for url in asked)


def settled(page: Page) -> str:
    """What the canvas says that it shows, as soon as it has nothing more to do."""
    page.wait_for_function("() => document.getElementById('canvas').dataset.shown")
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    found = page.locator("#canvas").get_attribute("data-shown")
    assert found is not None
    return found


def pixels(page: Page) -> np.ndarray:
    """The canvas, without the line that shows the focus and what is written at its foot."""
    settled(page)
    with Image.open(io.BytesIO(page.locator("#canvas").screenshot())) as image:
        return np.asarray(image.convert("RGB")).astype(int)[8:-100, 8:-8]


def drawn(image: np.ndarray) -> np.ndarray:
    return np.abs(image - BACKGROUND).max(axis=2) > 12


def changed(one: np.ndarray, other: np.ndarray) -> float:
    """Share of pixels that differ."""
    return float((np.abs(one - other).max(axis=2) > 12).mean())


def choose(page: Page, what: str) -> None:
    """Press one of the switches."""
    page.locator(f"label:has(#{what})").click()


def explored(page: Page, last: int) -> None:
    """Colours, cross-section, points and steps of a run, each of which changes what is seen."""
    plain = pixels(page)
    assert 0.05 < drawn(plain).mean() < 0.8
    assert page.locator("#scale").is_hidden()
    page.locator("#by").select_option("mean")
    coloured = pixels(page)
    assert changed(coloured, plain) > 0.03
    assert page.locator("#scale .ticks span").all_inner_texts()[2] == "0"
    assert "one over" in page.locator("#unit").inner_text()
    choose(page, "show-cut")
    cut = pixels(page)
    assert changed(cut, coloured) > 0.05
    assert page.locator("#where").inner_text().startswith("y = ")
    blue = (cut[..., 2] - cut[..., 0] > 40).mean()
    assert blue > 0.005
    page.locator("label:has(input[value=z])").click()
    assert settled(page).endswith("mean z500")
    across = pixels(page)
    assert changed(across, cut) > 0.05
    page.locator("#place").fill(page.locator("#place").get_attribute("max") or "")
    assert settled(page).endswith("mean z1000")
    page.locator("#face").click()
    assert changed(pixels(page), across) > 0.05
    choose(page, "show-cut")
    page.locator("#reset").click()
    assert changed(pixels(page), coloured) < 0.001
    page.locator("#step").fill("0")
    assert settled(page) == "step0 mean whole"
    assert f"Step 0 of {last}" in page.locator("#at").inner_text()
    assert page.locator("#curve .loss").count() == 1
    assert changed(pixels(page), coloured) > 0.05
    page.locator("#by").select_option("plain")
    page.locator("#step").fill(page.locator("#step").get_attribute("max") or "")
    assert settled(page).startswith("final")
    assert changed(pixels(page), plain) < 0.001
    choose(page, "show-points")
    assert changed(pixels(page), plain) > 0.005


def test_a_run_is_explored(browser: Browser, run_folder: Path):
    with served(Exhibit(Run(run_folder), 6_000)) as address, shown(browser, address) as page:
        assert page.title() == "part.run – weingarten view"
        expect(page.locator("#status")).to_contain_text("Fitted, 40 steps.", timeout=120_000)
        explored(page, 40)


def test_a_page_without_a_server_shows_the_same(
    browser: Browser, run_folder: Path, tmp_path: Path, monkeypatch
):
    monkeypatch.setattr(pages, "CUTS", 3)
    path, exhibit, seen = tmp_path / "part.html", Exhibit(Run(run_folder), 6_000), []
    assert write_page(exhibit, path) == path.stat().st_size < 20e6
    with served(exhibit) as live:
        for address in (live, path.as_uri()):
            with shown(browser, address, offline=address != live) as page:
                page.locator("#by").select_option("distance")
                choose(page, "show-cut")
                assert settled(page).endswith("distance y500")
                seen.append(pixels(page))
                choose(page, "show-cut")
                page.locator("#step").fill("3")
                assert settled(page) == "step4 distance whole"
                seen.append(pixels(page))
                choose(page, "show-cut")
                assert settled(page) == ("step4 distance y500" if address == live else "step4 distance whole")
    assert changed(seen[0], seen[2]) < 0.001
    assert changed(seen[1], seen[3]) < 0.001
    assert changed(seen[0], seen[1]) > 0.05


def test_the_part_turns_zooms_and_is_coloured_by_face(browser: Browser):
    with served(ball()) as address, shown(browser, address) as page:
        first = pixels(page)
        assert not drawn(first)[0].any()
        page.mouse.move(300, 300)
        page.mouse.wheel(0, -300)
        assert drawn(pixels(page)).mean() > 1.2 * drawn(first).mean()
        page.locator("#canvas").press("0")
        assert changed(pixels(page), first) < 0.001
        page.locator("#by").select_option("primitives")
        painted = pixels(page)
        assert page.locator("#names li").all_inner_texts() == ["0 dome"]
        page.locator("#canvas").press("ArrowUp")
        page.locator("#canvas").press("ArrowUp")
        assert changed(pixels(page), painted) > 0.01
        assert page.locator("h1").inner_text() == 'ball <b>&"$x'


def test_of_a_mesh_alone_what_needs_more_is_absent(browser: Browser):
    with served(Exhibit(Still("ball.stl", mesh(), None), 60_000)) as address, shown(browser, address) as page:
        assert 0.05 < drawn(pixels(page)).mean() < 0.8
        for absent in ("#shows", "#colouring", "#cutting", "#stepping", "#status"):
            assert page.locator(absent).is_hidden(), absent
        assert "5,120 triangles" in page.locator("#counts").inner_text()
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            for width in (900, 390):
                page.set_viewport_size({"width": width, "height": 700})
                assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_of_a_cloud_alone_the_points_are_shown(browser: Browser):
    exhibit = Exhibit(Known(cloud=ball().subject.cloud, now=Look()), 60_000)
    with served(exhibit) as address, shown(browser, address) as page:
        assert drawn(pixels(page)).mean() > 0.05
        assert page.locator("#counts").inner_text() == "20,000 points"
        assert page.locator("#shows").is_hidden()


def test_a_browser_without_webgl_is_told_so(browser: Browser):
    with served(ball()) as address, shown(browser, address, NO_WEBGL) as page:
        page.locator("#message", has_text="needs WebGL2").wait_for()
        assert page.locator("#colouring").is_hidden()


class Patient(Observer):
    """Waits after some steps until it is told to go on."""

    def __init__(self, steps: int) -> None:
        self.left, self.on = steps, threading.Event()

    def step(self, record: Record, steps: int, seconds: float) -> None:
        self.left -= 1
        if self.left == 0:
            assert self.on.wait(120)


def test_a_fit_is_followed_to_its_end(browser: Browser, tmp_path: Path, monkeypatch):
    """New steps appear while the page is open, and the final mesh when the fit has ended."""
    monkeypatch.setattr(reconstruction, "CHECKPOINT_SECONDS", 0.0)
    observer, points = Patient(12), sample_part("flange", 3000, 0)
    settings = wg.resolve(steps=30, points=200, resolution=40)
    folder = tmp_path / "part.run"
    fit = threading.Thread(
        target=lambda: wg.reconstruct(points, settings, run_folder=folder, observer=observer)
    )
    fit.start()
    while observer.left or not (folder / "checkpoint.safetensors").exists():
        time.sleep(0.05)
    with served(Exhibit(Run(folder), 6_000)) as address, shown(browser, address) as page:
        assert settled(page) == "step10 plain whole"
        assert "Step 11 of 30" in page.locator("#status").inner_text()
        ticks = page.locator("#curve .tick").count()
        observer.on.set()
        page.locator("#status", has_text="Fitted, 30 steps.").wait_for()
        page.wait_for_function(
            "() => (document.getElementById('canvas').dataset.shown || '').startsWith('final')"
        )
        assert page.locator("#curve .tick").count() == 15 > ticks
        page.locator("#step").fill("0")
        assert settled(page) == "step0 plain whole"
    fit.join()
