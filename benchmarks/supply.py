"""What is delivered with the package: a bill of materials (CycloneDX 1.5) and a table of licences.

    python benchmarks/supply.py build

Writes DIR/sbom.cdx.json and DIR/licences.md: the package, all that it needs, and what those need,
as installed here, with their pins of `constraints.txt`. Nothing is looked up anywhere.
"""

from __future__ import annotations

import json
import re
import sys
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

from irb2400_ctrl.files import write_atomic

NAME = "irb2400_ctrl"
CLASSIFIER = "License :: OSI Approved :: "


def needed(name: str) -> dict[str, Distribution]:
    """The package and all that it needs without extras, by normal name."""
    found: dict[str, Distribution] = {}
    waiting = [name]
    while waiting:
        one = normal(waiting.pop())
        if one in found:
            continue
        try:
            found[one] = distribution(one)
        except PackageNotFoundError:
            continue  # needed on another system only
        waiting += [
            re.split(r"[\s<>=!~;\[(]", text, maxsplit=1)[0]
            for text in found[one].requires or []
            if "extra ==" not in text
        ]
    return dict(sorted(found.items()))


def normal(name: str) -> str:
    """The name as package indices compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def licence(one: Distribution) -> str:
    """What the package says of itself: expression, classifiers, or the first line of its text."""
    data = one.metadata
    stated = data.get("License-Expression")
    if stated:
        return str(stated)
    classes = [c.removeprefix(CLASSIFIER) for c in data.get_all("Classifier") or []
               if c.startswith(CLASSIFIER)]  # fmt: skip
    text = (data.get("License") or "").strip().splitlines()
    return ", ".join(classes) or (text[0][:60] if text else "not stated")


def bill(packages: dict[str, Distribution]) -> dict[str, Any]:
    """The CycloneDX document; the same bytes for the same packages."""
    components = [
        {
            "type": "library",
            "bom-ref": f"pkg:pypi/{name}@{one.version}",
            "name": name,
            "version": one.version,
            "purl": f"pkg:pypi/{name}@{one.version}",
            "licenses": [{"license": {"name": licence(one)}}],
        }
        for name, one in packages.items()
    ]
    own = next(c for c in components if c["name"] == normal(NAME))
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": {**own, "type": "application"}},
        "components": [c for c in components if c is not own],
        "dependencies": [
            {
                "ref": f"pkg:pypi/{name}@{one.version}",
                "dependsOn": [
                    f"pkg:pypi/{other}@{packages[other].version}"
                    for other in _direct(one, packages)
                ],
            }
            for name, one in packages.items()
        ],
    }


def _direct(one: Distribution, packages: dict[str, Distribution]) -> list[str]:
    names = {
        normal(re.split(r"[\s<>=!~;\[(]", text, maxsplit=1)[0])
        for text in one.requires or []
        if "extra ==" not in text
    }
    return sorted(names & set(packages))


def main(out: Path) -> None:
    """Write both files and say what stands in them."""
    packages = needed(NAME)
    pins = dict(
        line.split("==") for line in
        (Path(__file__).parents[1] / "constraints.txt").read_text().splitlines() if "==" in line
    )  # fmt: skip
    pinned = {normal(name): version for name, version in pins.items()}
    write_atomic(out / "sbom.cdx.json", json.dumps(bill(packages), indent=2) + "\n")
    rows = ["| package | version | pin | licence |", "| --- | --- | --- | --- |"]
    rows += [
        f"| {name} | {one.version} | {pinned.get(name, '-')} | {licence(one)} |"
        for name, one in packages.items()
    ]
    write_atomic(out / "licences.md", "\n".join(rows) + "\n")
    print(f"{len(packages)} packages; written: {out / 'sbom.cdx.json'}, {out / 'licences.md'}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "build"))
