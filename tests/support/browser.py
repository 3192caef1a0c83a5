"""A headless Chromium that is on the machine, driven by Playwright; nothing is downloaded."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
# WebGL by SwiftShader, which needs no graphics card; nothing of the browser's own on the network
ARGUMENTS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]


@contextmanager
def chromium() -> Iterator[Any]:
    """A browser; skips the tests, with the reason, where there is none."""
    playwright = pytest.importorskip(
        "playwright.sync_api", reason="the Python package playwright is not installed"
    )
    path = next((found for name in NAMES if (found := shutil.which(name))), None)
    if path is None:
        pytest.skip(f"no browser is installed: none of {', '.join(NAMES)} is on the PATH")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=ARGUMENTS)
        try:
            yield browser
        finally:
            browser.close()


class OpenPage:
    """A page in a browser tab, with everything that it complained about or asked for."""

    def __init__(self, browser: Any, path: Path, width: int, height: int, dark: bool = False):
        self.context = browser.new_context(
            viewport={"width": width, "height": height}, color_scheme="dark" if dark else "light"
        )
        self.tab = self.context.new_page()
        self.tab.set_default_timeout(120_000)
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.tab.on("console", self._hear)
        self.tab.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.tab.on("request", lambda request: self.requests.append(request.url))
        self.tab.on("dialog", lambda dialog: self.complaints.append(f"dialog: {dialog.message}"))
        self.address = path.resolve().as_uri()
        self.tab.goto(self.address)

    def _hear(self, message: Any) -> None:
        # SwiftShader warns whenever pixels are read back
        if message.type in ("error", "warning") and "GPU stall" not in message.text:
            self.complaints.append(message.text)

    def ask(self, script: str) -> Any:
        """Value of a JavaScript expression."""
        return self.tab.evaluate(script)

    def wait(self, condition: str) -> None:
        """Wait until a JavaScript expression is true.

        Playwright's own function does it by eval, which the policy of a page forbids.
        """
        for _ in range(600):
            if self.ask(f"Boolean({condition})"):
                return
            self.tab.wait_for_timeout(100)
        raise AssertionError(f"{condition} was not true within a minute")

    def close(self) -> None:
        """Close the tab."""
        self.context.close()
