"""A real browser, offline, for the tests of pages; skipped where there is no chromium, but for CI=true."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page


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
