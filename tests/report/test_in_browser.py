"""A page in headless Chromium: silent, no wider than a phone, the arm moves and is where the model
says."""

from __future__ import annotations

import shutil
from pathlib import Path

import browser
import numpy as np
import pytest
from PIL import Image

import irb2400_ctrl as irb
from irb2400_ctrl.report import ArmView, Colouring, Page, Provenance
from irb2400_ctrl.report.elements.plots import Line, joint_plots, over_time

pytestmark = pytest.mark.skipif(browser.CHROMIUM is None, reason="no Chromium here")
PHONE = 500  # the narrowest window that Chromium opens; the page is put into 390 by the script
DARK = "--blink-settings=preferredColorScheme=0"
NARROW = (
    "document.documentElement.style.width = '390px';"
    "document.body.style.width = '390px';"
    "await new Promise((done) => setTimeout(done, 300));"
)


def motion() -> tuple[np.ndarray, np.ndarray]:
    time = np.linspace(0.0, 4.0, 400)
    sway = np.sin(0.5 * np.pi * time)
    return time, np.radians(np.outer(sway, [40.0, 20.0, -25.0, 50.0, 40.0, 90.0]))


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    robot = irb.load_robot("irb2400")
    time, q = motion()
    made = Page("A motion of " + "a_very_long_name_without_a_space_" * 4)
    made.answer("It can be driven.", "good", [(f"joint {j}", "12.3 → 0.4 Nm") for j in range(6)])
    made.heading("The motion")
    fields = (Colouring("speed 1", "deg/s", np.abs(q[:, 0])), Colouring("angle 2", "", q[:, 1]))
    made.arm(ArmView(robot, time, q, fields), "The arm.")
    made.heading("Angles")
    drawn = joint_plots(time, [Line(np.degrees(q))], "angle {joint} [deg]")
    made.figures(drawn, "Angles.", zoomable=True)
    made.figure(over_time(time, [Line(q[:, 0], label="one")], "angle [rad]"), "Wide.")
    made.heading("Numbers")
    head = ["name", *(f"a rather long column {k} [Nm]" for k in range(12))]
    made.table("A wide table", head, [["x", *(1.2345 for _ in range(12))]])
    made.provenance(Provenance.of(robot, [], "irb2400 plan " + "x" * 300))
    return made.write(tmp_path_factory.mktemp("page") / "report.html")


def test_the_console_is_empty(page: Path) -> None:
    assert browser.console(page) == []
    # the check sees what a page says
    loud = page.with_name("loud.html")
    loud.write_text(page.read_text().replace("</body>", "<script>nothing.there()</script></body>"))
    assert browser.console(loud)


def test_a_phone_needs_no_sideways_scrolling(page: Path) -> None:
    script = (
        NARROW + "return [...document.querySelectorAll('body *')].filter((e) => "
        "!e.closest('.scroll, .plotbox, svg') && e.getBoundingClientRect().right > 391)"
        ".map((e) => e.tagName + ' ' + e.className).slice(0, 5);"
    )
    assert browser.answer(page, script, width=PHONE) == []


def test_the_tip_is_where_the_model_has_it(page: Path) -> None:
    script = (
        "const a = document.querySelector('figure.arm').arm, found = [];"
        "for (const t of [0, 0.7, 1.3, 2.9, 4]) { a.at(t); found.push("
        "[a.time, ...a.figure.dataset.tip.split(',').map(Number)]); } return found;"
    )
    model = irb.Model(irb.load_robot("irb2400"))
    time, q = motion()
    for at, *tip in browser.answer(page, script):
        angles = np.array([np.interp(at, time, column) for column in q.T])
        assert np.abs(model.tcp_pose(angles)[:3, 3] - tip).max() < 1e-3


def test_the_arm_plays_and_the_figures_follow(page: Path) -> None:
    script = (
        "const a = document.querySelector('figure.arm').arm;"
        "const pixels = () => { const gl = a.gl, w = a.solid.width, h = a.solid.height;"
        " const found = new Uint8Array(4 * w * h);"
        " gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, found); return found; };"
        "const before = pixels(); a.at(1.0); const after = pixels();"
        "let changed = 0; for (let k = 0; k < before.length; k += 4)"
        " if (Math.abs(before[k] - after[k]) > 20) changed++;"
        # without a window nobody asks for frames
        "let now = 0; window.requestAnimationFrame = (f) => setTimeout(() => f(now += 16), 16);"
        "a.at(0); a.button.click();"
        # drawing without a graphics card takes its time on a busy machine
        "for (let k = 0; k < 40 && !(a.time > 0); k++)"
        " await new Promise((done) => setTimeout(done, 100));"
        "const played = a.time; a.button.click();"
        "const line = document.querySelector('.cursor');"
        "return { changed, played, playing: a.playing, mark: line.getAttribute('visibility') };"
    )
    found = browser.answer(page, script)
    assert found["changed"] > 1000
    assert found["played"] > 0.0
    assert found["playing"] is False
    assert found["mark"] == "visible"


def test_the_whole_arm_is_in_the_picture(page: Path) -> None:
    """Orange, the colour of its links, reaches no edge at any time of the motion."""
    script = (
        "const a = document.querySelector('figure.arm').arm, found = [];"
        "const [w, h] = [a.solid.width, a.solid.height], pixels = new Uint8Array(4 * w * h);"
        "for (const t of [0, 1, 2, 3, 4]) { a.at(t);"
        " a.gl.readPixels(0, 0, w, h, a.gl.RGBA, a.gl.UNSIGNED_BYTE, pixels);"
        " let all = 0, edge = 0; for (let y = 0; y < h; y++) for (let x = 0; x < w; x++) {"
        "  const k = 4 * (y * w + x);"
        "  if (pixels[k] < 90 || pixels[k] < 2 * pixels[k + 2]) continue; all++;"
        "  if (x < 3 || y < 3 || x > w - 4 || y > h - 4) edge++; } found.push([all, edge]); }"
        "return found;"
    )
    for whole, edge in browser.answer(page, script):
        assert whole > 3000
        assert edge == 0


def test_a_drag_zooms_all_joints_and_a_double_click_undoes_it(page: Path) -> None:
    script = (
        "const svg = document.querySelector('.zoomable svg'), box = svg.getBoundingClientRect();"
        "const at = (kind, x) => svg.dispatchEvent(new PointerEvent(kind, { pointerId: 1, "
        "clientX: box.left + x * box.width, clientY: box.top + 0.5 * box.height }));"
        "svg.setPointerCapture = () => {};"
        "const moved = () => document.querySelectorAll('.zoomable [transform^=matrix]').length;"
        "const before = moved(); at('pointerdown', 0.4); at('pointermove', 0.6); "
        "at('pointerup', 0.6); const during = moved();"
        "svg.dispatchEvent(new MouseEvent('dblclick')); return [before, during, moved()];"
    )
    before, during, after = browser.answer(page, script)
    assert before == after == 0
    assert during >= 6


@pytest.mark.parametrize("flags", [(), (DARK,)], ids=["light", "dark"])
def test_letters_stand_out(page: Path, flags: tuple[str, ...]) -> None:
    """Text of page and figures against what is behind it (WCAG asks for a contrast of 4.5)."""
    script = (
        "const paper = getComputedStyle(document.body).backgroundColor;"
        "const texts = [...document.querySelectorAll('svg text')].map((t) => "
        "getComputedStyle(t).fill); return [paper, getComputedStyle(document.body).color, "
        "...new Set(texts)];"
    )
    paper, *inks = browser.answer(page, script, *flags)
    for ink in inks:
        assert contrast(paper, ink) > 4.5
    assert (luminance(paper) < 0.2) is bool(flags)


def test_print_is_light_and_has_no_buttons(page: Path, tmp_path: Path) -> None:
    out = tmp_path / "page.pdf"
    browser._run(page, f"--print-to-pdf={out}", "--no-pdf-header-footer", DARK)
    assert out.read_bytes().startswith(b"%PDF")
    if shutil.which("pdftoppm") is None:
        return
    import subprocess

    subprocess.run(["pdftoppm", "-r", "40", "-png", out, tmp_path / "sheet"], check=True)
    sheets = sorted(tmp_path.glob("sheet*.png"))
    for sheet in sheets:
        assert np.asarray(Image.open(sheet).convert("L")).mean() > 128


def luminance(colour: str) -> float:
    values = [float(v) / 255 for v in colour[colour.index("(") + 1 : -1].split(",")[:3]]
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in values]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)
