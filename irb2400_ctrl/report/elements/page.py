"""A report: one self-contained HTML file that answers first, then shows, then says where it is from.

Every verb's page is made of the same parts, so a new one only names them:

    page = Page("Plan of part.apt")
    page.answer("The part can be driven as programmed.", "good", [("duration", "30.1 s")])
    page.heading("Torque")
    page.figures([figure_of_joint_1, figure_of_joint_2], "Torque of each joint.")
    page.provenance(Provenance.of(robot, [path]))
    page.write("report.html")
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import zip_longest
from math import floor, isfinite, log10
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.report.elements.glossary import WORDS, slug, words_in
from irb2400_ctrl.report.elements.inline_svg import inline_svg
from irb2400_ctrl.report.elements.provenance import Provenance
from irb2400_ctrl.system import give_back_freed
from irb2400_ctrl.version import VERSION

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup
    from matplotlib.figure import Figure

    from irb2400_ctrl.report.elements.arm_view import ArmView

Grade = Literal["good", "note", "bad"]
TEMPLATES = Path(__file__).parent / "templates"
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass
class Part:
    """One block of a page: its kind names the macro of the template, the rest is its data."""

    kind: str
    data: dict[str, Any]


@dataclass
class Section:
    """Parts under one heading."""

    title: str
    name: str
    parts: list[Part] = field(default_factory=list)
    minor: bool = False


@dataclass
class Page:
    """A page under construction; add parts in reading order, then `write`."""

    title: str
    sections: list[Section] = field(default_factory=list)
    refresh: float | None = None
    """[s] after which a browser loads the page anew: of what still goes on"""
    _answer: dict[str, Any] | None = None
    _provenance: Provenance | None = None
    _figures: int = 0
    _scripts: set[str] = field(default_factory=set)

    def answer(
        self, sentence: str, grade: Grade = "note", facts: Sequence[tuple[str, str]] = ()
    ) -> None:
        """What the reader came for, above everything else.

        Args:
            sentence: the verdict in plain words.
            grade: how it is coloured; the sentence says it too.
            facts: a few names and values with their units.
        """
        self._answer = {"sentence": sentence, "grade": grade, "facts": list(facts)}

    def provenance(self, provenance: Provenance) -> None:
        """Where the page comes from, at its end."""
        self._provenance = provenance

    def heading(self, text: str, minor: bool = False) -> None:
        """A new section; a minor one is left out of the contents list."""
        name = slug(text)
        taken = {section.name for section in self.sections}
        number = 2
        while name in taken:
            name = f"{slug(text)}-{number}"
            number += 1
        self.sections.append(Section(text, name, minor=minor))

    def text(self, text: str) -> None:
        """A paragraph."""
        self._add("text", text=text)

    def finding(self, text: str) -> None:
        """A paragraph that stands out."""
        self._add("finding", text=text)

    def table(
        self,
        caption: str,
        head: Sequence[str],
        rows: Sequence[Sequence[object]],
        folded: bool = False,
    ) -> None:
        """A table; numbers with three significant digits or as they are given in text.

        Args:
            caption: what it shows.
            head: names of the columns, with units.
            rows: a row a thing.
            folded: closed until the reader opens it.
        """
        # in a narrow column a number and its error stay together
        beside = "\N{NO-BREAK SPACE}±\N{NO-BREAK SPACE}"
        texts = [[show(value).replace(" ± ", beside) for value in row] for row in rows]
        words = [_in_words(column) for column in zip_longest(*texts, fillvalue="")] or [
            False
        ] * len(head)
        self._add(
            "table", caption=caption, head=list(head), rows=texts, folded=folded, words_in=words
        )

    def figure(self, figure: Figure, caption: str, zoomable: bool = False) -> None:
        """One wide figure as SVG.

        Args:
            figure: about 7 in wide.
            caption: what it shows.
            zoomable: along x, in place; for records over time.
        """
        self._add_figures([figure], caption, zoomable, wide=True)

    def figures(self, figures: Iterable[Figure], caption: str, zoomable: bool = False) -> None:
        """Small figures side by side, one below the other on a phone.

        Args:
            figures: about 4.6 in wide.
            caption: what they show.
            zoomable: along x, all of them together.
        """
        self._add_figures(list(figures), caption, zoomable, wide=False)

    def arm(self, view: ArmView, caption: str) -> None:
        """The arm in its cell, to turn and to play."""
        self._figures += 1
        self._scripts.add("arm.js")
        self._add("arm", name=f"arm{self._figures}", view=view.data(), caption=caption)

    def _add_figures(
        self, figures: Sequence[Figure], caption: str, zoomable: bool, wide: bool
    ) -> None:
        from markupsafe import Markup

        drawn = []
        for figure in figures:
            self._figures += 1
            drawn.append(Markup(inline_svg(figure, f"f{self._figures}", zoomable)))
            # its parts hold on to each other, and would stay
            figure.clear()
        if zoomable:
            self._scripts.add("zoom.js")
        self._add("figures", svgs=drawn, caption=caption, wide=wide, zoomable=zoomable)

    def _add(self, kind: str, **data: Any) -> None:
        if not self.sections:
            self.sections.append(Section("", "start"))
        self.sections[-1].parts.append(Part(kind, data))
        # what a figure or a view was made of is several times as much as the part
        give_back_freed()

    def body(self) -> str:
        """The page without its head and scripts."""
        return _environment().get_template("body.html").render(self._content())

    def html(self) -> str:
        """The whole page."""
        scripts = [_source(name) for name in sorted(self._scripts)]
        return (
            _environment()
            .get_template("page.html")
            .render(self._content(), style=_source("page.css"), scripts=scripts)
        )

    def _content(self) -> dict[str, Any]:
        return {
            "title": self.title,
            "refresh": self.refresh,
            "answer": self._answer,
            "sections": self.sections,
            "contents": [s for s in self.sections if s.title and not s.minor],
            "provenance": self._provenance,
            "version": VERSION,
            "words": Words(),
        }

    def _repr_html_(self) -> str:
        """In a notebook: the page in a frame of its own."""
        from markupsafe import escape

        style = "width: 100%; height: 40rem; border: 0"
        inside = escape(self.html())
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{inside}"></iframe>'

    def write(self, path: Path | str) -> Path:
        """Write the page as one file."""
        return write_atomic(path, self.html())


class Words:
    """Explains words of the glossary where a page uses them first, and lists them at its end."""

    def __init__(self) -> None:
        self.used: dict[str, str] = {}

    def __call__(self, text: str) -> Markup:
        """The text, escaped, with the words it uses linked to their explanation."""
        from markupsafe import Markup, escape

        found = Markup()
        at = 0
        for start, end, word in words_in(text):
            if word in self.used:
                continue
            self.used[word] = WORDS[word]
            link = Markup('<a class="word" href="#word-{}"><abbr title="{}">{}</abbr></a>')
            found += escape(text[at:start]) + link.format(slug(word), WORDS[word], word)
            at = end
        return found + escape(text[at:])


@cache
def _environment() -> Environment:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    # everything is escaped: names of files, logs and CAM programs are a stranger's text
    made = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["slug"] = slug
    return made


@cache
def _source(name: str) -> Markup:
    """A style or script of ours, put in as it is."""
    from markupsafe import Markup

    return Markup((TEMPLATES / name).read_text(encoding="utf-8"))


def sentence(text: str) -> str:
    """A remark with a capital and a full stop; the name of a file before a colon stays as it is."""
    first = text.partition(":")[0]
    named = ":" in text and "." in first and " " not in first
    return f"{text if named else capital(text)}."


def capital(text: str) -> str:
    """With a capital."""
    return text[:1].upper() + text[1:]


def _in_words(column: Sequence[str]) -> bool:
    """Whether a column of a table is read from the left: every entry begins with a letter."""
    told = [text for text in column if text not in ("", "-")]
    return bool(told) and all(text[0].isalpha() for text in told)


def show(value: object) -> str:
    """A number for a reader: three significant digits, also where they are zeros; anything else as
    text."""
    if not isinstance(value, float):  # numpy's float64 is one too
        return str(value)
    if not isfinite(value):
        return "-"
    if value == 0.0:
        return "0"
    if abs(value) >= 99.95:
        return f"{value:,.0f}"
    mantissa, _, power = f"{value:#.3g}".partition("e")
    return f"{mantissa}·10{str(int(power)).translate(_RAISED)}" if power else mantissa


def of_limit(ratio: float) -> str:
    """`81 % of limit`; one digit more where rounding would say that a limit is reached."""
    percent = 100.0 * ratio
    near = 99.0 <= percent < 100.0
    return f"{percent:.1f} % of limit" if near else f"{percent:.0f} % of limit"


def with_error(value: float, error: float) -> str:
    """`3.080 ± 0.011`: two digits of a standard error, and as many places of its value."""
    if not (isfinite(error) and error > 0.0):
        return show(value)
    places = max(0, 1 - floor(log10(error)))
    if places > 6:
        return f"{show(value)} ± {show(error)}"
    return f"{value:,.{places}f} ± {error:,.{places}f}"
