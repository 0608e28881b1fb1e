"""A Matplotlib figure as SVG inside a page: its colours are the page's, its ids its own."""

from __future__ import annotations

import io
import json
import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = {
    "#000000": "ink",
    "#ffffff": "paper",
    "#b0b0b0": "grid",
    "#cccccc": "band",
    "#999999": "muted",
    "#8c8c8c": "muted",
    "#808080": "muted",
    "#595959": "muted",
    "#1f77b4": "blue",
    "#ff7f0e": "orange",
    "#2ca02c": "green",
    "#d62728": "red",
    "#9467bd": "violet",
    "#8c564b": "brown",
    "#e377c2": "pink",
    "#7f7f7f": "muted",
    "#bcbd22": "olive",
    "#17becf": "cyan",
}
"""what Matplotlib writes -> the CSS variable that light and dark pages give a value to"""
NUMBER = re.compile(r"-?\d+\.\d{2,}")
CURVE = re.compile(r'\bd="[^"]*"')
TAG = re.compile(r"<[^>]*>")
"""what is between them is for the reader and stays as it is"""
COLOUR = re.compile(r"#[0-9a-f]{6}\b")
FONT = re.compile(r"font: (?:(\w+) )?([\d.]+)px [^;\"]*")
DROPPED = (
    re.compile(r"^.*?(?=<svg)", re.DOTALL),
    re.compile(r"<metadata>.*?</metadata>", re.DOTALL),
    re.compile(r"<defs>\s*<style.*?</defs>", re.DOTALL),
    re.compile(r"<!--.*?-->", re.DOTALL),
)
POINTS_PER_INCH = 72.0


def inline_svg(figure: Figure, name: str, zoomable: bool = False) -> str:
    """The figure as an <svg> element without a size of its own.

    The same figure gives the same text: ids follow from what is drawn, and nothing tells a time.

    Args:
        figure: drawn with Matplotlib's own colours, at most 5 in wide if it is to be read on a
            phone.
        name: put before every id, so that two figures of a page share none.
        zoomable: say where the axes are, for the script that zooms along x.
    """
    import matplotlib as mpl
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    buffer = io.StringIO()
    # text stays text, in the font of the page; long lines keep what a zoom shows
    rules: dict[Any, Any] = {
        "svg.fonttype": "none",
        "svg.hashsalt": name,
        "path.simplify_threshold": 0.03,
    }
    with mpl.rc_context(rules):
        FigureCanvasSVG(figure)
        engine = figure.get_layout_engine()
        if engine is not None:
            # once, here: to lay it out, savefig would draw it a second time
            engine.execute(figure)
            figure.set_layout_engine(None)
        figure.savefig(buffer, format="svg", transparent=True, metadata={"Date": None})
        places = json.dumps(_places(figure)) if zoomable else ""
    text = buffer.getvalue()
    for pattern in DROPPED:
        text = pattern.sub("", text)
    text = TAG.sub(_tidied, text)
    text = FONT.sub(r"font-size: \2px", text)
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r'(url\(#|href="#)', rf"\g<1>{name}-", text)
    return _opened(text, name, places)


def _tidied(tag: re.Match[str]) -> str:
    """Colours of the page; places to a hundredth of a point, those of curves to a tenth."""
    text = COLOUR.sub(_variable, tag[0])
    text = CURVE.sub(lambda curve: _shorter(curve[0].replace("\n", ""), 1), text)
    return _shorter(text, 2)


def _shorter(text: str, digits: int) -> str:
    def short(number: re.Match[str]) -> str:
        return f"{float(number[0]):.{digits}f}".rstrip("0").rstrip(".")

    return NUMBER.sub(short, text)


def _variable(found: re.Match[str]) -> str:
    name = COLOURS.get(found[0])
    return found[0] if name is None else f"var(--{name})"


def _opened(text: str, name: str, places: str) -> str:
    """With an opening tag of ours: a view box, no width and height."""
    box = re.search(r'viewBox="([^"]+)"', text)
    assert box is not None  # Matplotlib always writes one
    data = f" data-axes='{places}'" if places else ""
    opening = f'<svg class="plot" id="{name}" viewBox="{box[1]}" role="img"{data}>'
    return re.sub(r"<svg[^>]*>", lambda _: opening, text, count=1)


def _places(figure: Figure) -> list[dict[str, object]]:
    """Of each axes: its id in the file, its box in the view and its limits along x."""
    width, height = figure.get_size_inches() * POINTS_PER_INCH
    found: list[dict[str, object]] = []
    for number, axes in enumerate(figure.axes, start=1):
        box = axes.get_position()
        left = box.x0 * width
        right = box.x1 * width
        top = (1 - box.y1) * height
        bottom = (1 - box.y0) * height
        found.append(
            {
                "id": f"axes_{number}",
                "box": [round(float(v), 2) for v in (left, top, right, bottom)],
                "x": [float(v) for v in axes.get_xlim()],
            }
        )
    return found
