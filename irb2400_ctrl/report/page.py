"""A self-contained HTML page: text, tables and figures in one file."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from irb2400_ctrl.files import write_atomic

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #1c2024; margin: 0 auto;
  max-width: 60rem; padding: 1rem 1.5rem 4rem; }
h1 { font-size: 1.7rem; } h2 { font-size: 1.25rem; margin-top: 2.2rem; border-bottom: 1px solid #ccd3da; }
table { border-collapse: collapse; margin: 0.8rem 0; } caption { text-align: left; color: #55606b; padding: 0.2rem 0; }
th, td { padding: 0.2rem 0.8rem; text-align: right; border-bottom: 1px solid #e4e8ec; }
td { font-variant-numeric: tabular-nums; }
th { background: #f3f5f7; } th:first-child, td:first-child { text-align: left; }
figure { margin: 1rem 0; } figure img { max-width: 100%; } figcaption { color: #55606b; font-size: 0.92rem; }
.finding { border-left: 4px solid #2a6fb0; background: #f3f8fc; padding: 0.5rem 1rem; margin: 0.8rem 0; }
"""


@dataclass
class Page:
    """A page under construction; add parts in reading order, then `write`."""

    title: str
    _parts: list[str] = field(default_factory=list)

    def heading(self, text: str) -> None:
        """A section heading."""
        self._parts.append(f"<h2>{html.escape(text)}</h2>")

    def text(self, text: str) -> None:
        """A paragraph."""
        self._parts.append(f"<p>{html.escape(text)}</p>")

    def finding(self, text: str) -> None:
        """A paragraph that stands out."""
        self._parts.append(f'<div class="finding">{html.escape(text)}</div>')

    def table(self, caption: str, head: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
        """A table; numbers with three significant digits or as they are given in text."""
        cells = "".join(f"<th>{html.escape(name)}</th>" for name in head)
        body = "".join(
            "<tr>" + "".join(f"<td>{html.escape(show(v))}</td>" for v in row) + "</tr>"
            for row in rows
        )
        self._parts.append(
            f"<table><caption>{html.escape(caption)}</caption><tr>{cells}</tr>{body}</table>"
        )

    def figure(self, figure: Figure, caption: str) -> None:
        """A figure, embedded as PNG."""
        buffer = io.BytesIO()
        # without metadata the same figure gives the same bytes
        figure.savefig(
            buffer, format="png", dpi=110, bbox_inches="tight", metadata={"Software": None}
        )
        data = base64.b64encode(buffer.getvalue()).decode()
        text = html.escape(caption)
        self._parts.append(
            f'<figure><img alt="{text}" '
            f'src="data:image/png;base64,{data}"><figcaption>{text}</figcaption></figure>'
        )

    def write(self, path: Path | str) -> Path:
        """Write the page as one file."""
        title = html.escape(self.title)
        head = (
            f'<meta charset="utf-8"><meta name="viewport" '
            f'content="width=device-width"><title>{title}</title>'
        )
        parts = "\n".join(self._parts)
        return write_atomic(
            path,
            f'<!doctype html><html lang="en"><head>{head}<style>{STYLE}</style></head>'
            f"<body><h1>{title}</h1>\n{parts}\n</body></html>\n",
        )


def show(value: object) -> str:
    """A number for a reader: three significant digits; anything else as text."""
    if isinstance(value, float):  # numpy's float64 is one too
        magnitude = abs(value)
        if magnitude >= 100:
            return f"{value:,.0f}"
        return f"{value:.3g}"
    return str(value)
