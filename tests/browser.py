"""A page in headless Chromium: what it prints to the console, what a script finds, how it looks."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
CHROMIUM = next((found for name in NAMES if (found := shutil.which(name))), None)
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
    "--disable-background-networking",
    "--virtual-time-budget=6000",
    "--enable-logging=stderr",
)
SECONDS = 240


def _run(page: Path, *flags: str) -> subprocess.CompletedProcess[str]:
    assert CHROMIUM is not None
    profile = f"--user-data-dir={page.parent / 'profile'}"
    return subprocess.run(
        [CHROMIUM, *FLAGS, profile, *flags, page.as_uri()],
        capture_output=True,
        text=True,
        check=True,
        timeout=SECONDS,
    )


def console(page: Path, *flags: str) -> list[str]:
    """Lines that the page writes to the console, errors of the page included."""
    return re.findall(r"CONSOLE.*", _run(page, "--dump-dom", *flags).stderr)


def answer(page: Path, script: str, *flags: str, width: int = 1100) -> Any:
    """What a script returns that runs in the page once it is there; it may await.

    A page that writes to the console is an error.
    """
    probe = page.with_name(f"probe_{page.name}")
    tail = (
        "<script>window.addEventListener('load', async () => {"
        f"const found = await (async () => {{ {script} }})();"
        "const pre = document.createElement('pre'); pre.id = 'probe';"
        "pre.textContent = JSON.stringify(found); document.body.append(pre); });</script></body>"
    )
    probe.write_text(page.read_text().replace("</body>", tail))
    done = _run(probe, "--dump-dom", f"--window-size={width},900", *flags)
    assert "CONSOLE" not in done.stderr, done.stderr
    found = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.DOTALL)
    assert found, "the script of the probe did not end"
    probe.unlink()
    return json.loads(found[1].replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))


def arm_moves(page: Path) -> bool:
    """Whether the arm of a page, which says nothing to the console, has its tip elsewhere later."""
    script = (
        "const a = document.querySelector('figure.arm').arm, found = [];"
        "for (const t of [a.data.start, (a.data.start + a.data.stop) / 2]) {"
        " a.at(t); found.push(a.figure.dataset.tip); } return found;"
    )
    first, later = answer(page, script)
    return bool(first != later)
