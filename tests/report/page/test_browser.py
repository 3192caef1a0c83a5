"""Pages in a real browser, from disk: what is drawn, what moves, what the buttons do.

The browser renders by SwiftShader, on the processor. Poses of links are compared with Pinocchio,
which shares no code with the script of the page.
"""

from __future__ import annotations

import dataclasses
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray
from PIL import Image

from mgs.motion import Motion
from mgs.report.page import PageOptions, write_page
from tests.report.page.conftest import BROKEN_TIME, HOSTILE
from tests.support.browser import OpenPage, chromium

pytestmark = pytest.mark.filterwarnings("default")  # those of Playwright itself
WIDE, PHONE = (1400, 900), (390, 844)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


@pytest.fixture(scope="module")
def folder(
    browser: Any, walk: Motion, broken: Motion, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """Pages of the walk with a replay, of the broken walk, and of both side by side."""
    path = tmp_path_factory.mktemp("pages")
    write_page([walk], path / "walk.html", PageOptions(engines=("mujoco",)))
    write_page([broken], path / "broken.html")
    write_page([walk, broken], path / "both.html")
    return path


@pytest.fixture(scope="module")
def page(browser: Any, folder: Path) -> Iterator[OpenPage]:
    opened = OpenPage(browser, folder / "walk.html", *WIDE)
    opened.wait("window.mgsFirstFrame")
    yield opened
    opened.close()


@pytest.fixture(scope="module")
def broken_page(browser: Any, folder: Path) -> Iterator[OpenPage]:
    opened = OpenPage(browser, folder / "broken.html", *PHONE, dark=True)
    opened.wait("window.mgsFirstFrame")
    yield opened
    opened.close()


def pixels(page: OpenPage) -> NDArray[np.int16]:
    """The 3D view as it is on the screen."""
    canvas = page.tab.locator(".stage canvas").first
    page.ask("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return np.asarray(Image.open(io.BytesIO(canvas.screenshot())).convert("RGB"), dtype=np.int16)


def set_time(page: OpenPage, t: float) -> None:
    page.ask(f"mgsPage.clock.set({t})")


def test_the_view_shows_a_robot_on_the_ground(page: OpenPage):
    set_time(page, 0.0)
    picture = pixels(page)
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 500
    orange = (picture[..., 0] > 150) & (picture[..., 0] - picture[..., 2] > 60)  # Melson's shell
    assert orange.mean() > 0.005


def test_scrubbing_moves_the_robot(page: OpenPage):
    """The slider itself is moved, as a user does, with the camera at rest."""
    page.ask("mgsPage.views[0].setFollow(false)")
    set_time(page, 0.0)
    before = pixels(page)
    slider = page.tab.locator(".transport input[type=range]")
    slider.focus()
    slider.press("End")
    after = pixels(page)
    page.ask("mgsPage.views[0].setFollow(true)")
    assert page.ask("mgsPage.clock.time") == pytest.approx(page.ask("mgsPage.clock.duration"))
    assert (np.abs(after - before).max(axis=2) > 40).mean() > 0.02


@pytest.mark.parametrize("sample", [0, 100, 217])
def test_every_link_is_where_pinocchio_places_it(page: OpenPage, walk: Motion, sample: int):
    set_time(page, sample * walk.dt)
    placed = page.ask(
        """(() => {
          const model = mgsPage.views[0].parts.find((part) => part.name === "Robot").model;
          model.root.updateWorldMatrix(false, true);
          return Object.fromEntries(Object.entries(model.links).map(([name, link]) =>
            [name, link.getWorldPosition(new THREE.Vector3()).toArray()]));
        })()"""
    )
    model, data = walk.robot.model, walk.robot.model.createData()
    pin.framesForwardKinematics(model, data, walk.q[sample])
    assert len(placed) > 15
    for name, position in placed.items():
        expected = data.oMf[model.getFrameId(name)].translation
        # 16 bits of a joint angle are less than 1e-4 rad, the longest chain less than 0.5 m
        np.testing.assert_allclose(position, expected, atol=1e-4, err_msg=name)


def test_play_and_pause_by_keyboard(page: OpenPage):
    set_time(page, 0.0)
    page.ask("document.activeElement.blur()")
    page.tab.keyboard.press("Space")
    page.wait("mgsPage.clock.time > 0.05")
    page.tab.keyboard.press("Space")
    assert page.ask("mgsPage.clock.playing") is False
    at = page.ask("mgsPage.clock.time")
    page.tab.keyboard.press("ArrowRight")
    assert page.ask("mgsPage.clock.time") == pytest.approx(min(at + 0.05, walk_end(page)))
    page.tab.keyboard.press("Home")
    assert page.ask("mgsPage.clock.time") == 0.0


def walk_end(page: OpenPage) -> float:
    return float(page.ask("mgsPage.clock.duration"))


def test_every_button_and_every_box_changes_something(page: OpenPage):
    """No control is dead: each changes the picture, the clock or the state of the page."""
    state = "JSON.stringify([mgsPage.clock, document.documentElement.dataset.theme, " \
        "document.querySelector('#app').innerHTML.length, mgsPage.views[0].camera.position, " \
        "mgsPage.views[0].shown, [...document.querySelectorAll('[aria-pressed]')]" \
        ".map((b) => b.getAttribute('aria-pressed'))])"  # fmt: skip
    buttons = page.tab.locator("button")
    dead = []
    for i in range(buttons.count()):
        name = buttons.nth(i).inner_text()
        page.ask("mgsPage.views[0].look('Corner'); mgsPage.clock.set(0.123)")
        if name == "Corner":
            page.ask("mgsPage.views[0].look('Top')")
        if buttons.nth(i).get_attribute("aria-pressed") == "true" and name != "Follow":
            continue  # the joint that is shown
        before = page.ask(state)
        buttons.nth(i).evaluate("(button) => button.click()")
        page.ask("mgsPage.clock.pause()") if name != "Play" else None
        if page.ask(state) == before:
            dead.append(name)
        page.ask("mgsPage.clock.pause()")
    assert dead == []
    boxes = page.tab.locator("input[type=checkbox]")
    assert boxes.count() >= 8
    for i in range(boxes.count()):
        before = page.ask("JSON.stringify(mgsPage.views[0].parts.map((p) => p.object.visible))")
        boxes.nth(i).evaluate("(box) => box.click()")
        hidden = page.ask("JSON.stringify(mgsPage.views[0].parts.map((p) => p.object.visible))")
        boxes.nth(i).evaluate("(box) => box.click()")
        assert hidden != before, i


def test_the_replay_stands_beside_the_plan(page: OpenPage):
    set_time(page, 1.0)
    ghost = page.ask(
        "mgsPage.views[0].parts.filter((p) => p.name === 'mujoco' && p.object.visible).length"
    )
    assert ghost >= 2  # the robot, and the force on at least one sole
    assert "mujoco: tilt" in page.tab.locator(".readout").inner_text()


def test_a_click_into_a_plot_goes_to_its_time(page: OpenPage):
    plot = page.tab.locator(".plot canvas").nth(1)
    plot.scroll_into_view_if_needed()
    box = plot.bounding_box()
    assert box is not None
    plot.click(position={"x": 52 + 0.5 * (box["width"] - 62), "y": 0.5 * box["height"]})
    assert page.ask("mgsPage.clock.time") == pytest.approx(0.5 * walk_end(page), rel=0.02)


def test_a_click_on_a_failed_check_goes_to_its_worst_moment(broken_page: OpenPage):
    set_time(broken_page, 0.0)
    failed = broken_page.tab.locator("tr.fail button[data-check=joint_position]")
    failed.scroll_into_view_if_needed()
    failed.click()
    assert broken_page.ask("mgsPage.clock.time") == pytest.approx(BROKEN_TIME, abs=1e-6)
    chosen = broken_page.tab.locator(".chips button[aria-pressed=true]").inner_text()
    assert chosen == "left elbow pitch"


def test_hostile_names_are_shown_as_they_are(broken_page: OpenPage):
    heading = broken_page.ask("document.querySelector('h1').textContent")
    assert heading == f"{HOSTILE} of melson"
    assert broken_page.ask("document.querySelectorAll('img').length") == 0


@pytest.mark.parametrize(
    ("name", "size"), [("walk", PHONE), ("broken", WIDE), ("both", WIDE), ("both", PHONE)]
)
def test_a_page_complains_about_nothing_and_asks_for_nothing(
    browser: Any, folder: Path, name: str, size: tuple[int, int]
):
    opened = OpenPage(browser, folder / f"{name}.html", *size)
    opened.wait("window.mgsFirstFrame")
    opened.ask("mgsPage.clock.set(1)")
    opened.ask("scrollTo(0, document.body.scrollHeight)")
    assert opened.complaints == []
    assert opened.requests == [opened.address]
    assert opened.ask("document.documentElement.scrollWidth") <= size[0]
    views = opened.ask("mgsPage.views.length")
    assert views == (2 if name == "both" else 1)
    opened.close()


def test_both_motions_follow_one_clock(browser: Any, folder: Path):
    opened = OpenPage(browser, folder / "both.html", *WIDE)
    opened.wait("window.mgsFirstFrame")
    opened.ask("mgsPage.clock.set(1.2)")
    assert opened.ask("mgsPage.views.map((view) => view.time)") == [1.2, 1.2]
    opened.close()


def test_without_webgl_verdict_and_plots_remain(browser: Any, folder: Path):
    context = browser.new_context()
    tab = context.new_page()
    tab.add_init_script(
        "const real = HTMLCanvasElement.prototype.getContext;"
        "HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {"
        "  return kind.startsWith('webgl') ? null : real.call(this, kind, ...rest); };"
    )
    tab.goto((folder / "walk.html").as_uri())
    tab.wait_for_selector(".verdict tr")
    assert "no WebGL" in tab.locator(".stage").inner_text()
    assert tab.locator(".plot canvas").count() > 5
    context.close()


def test_a_motion_without_balance_shows_no_zmp(browser: Any, walk: Motion, tmp_path: Path):
    """Nothing is known of its contacts, so neither its forces nor its torques are."""
    gait = walk.gait.model_copy()
    unbalanced = dataclasses.replace(walk, gait=gait)
    kind = type(gait)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kind, "is_balanced", property(lambda self: False))
        write_page([unbalanced], tmp_path / "page.html")
    opened = OpenPage(browser, tmp_path / "page.html", *WIDE)
    opened.wait("window.mgsFirstFrame")
    names = opened.ask("mgsPage.views[0].parts.map((part) => part.name)")
    assert "ZMP" not in names and "Robot" in names
    assert opened.complaints == []
    opened.close()
