"""Pages of reference, written from what the library says of itself: effects, files, commands,
API."""

from __future__ import annotations

import ast
import inspect
import types
import typing
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from typer.main import get_command

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.cli.schema import FILES, schema_of
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.report.effect_words import explain
from irb2400_ctrl.report.elements.glossary import WORDS
from irb2400_ctrl.report.figures.effect_figure import effect_figure

SENTENCES = {
    "robot": "A robot file describes an arm: links, joints, tool, uncertainty, effects.",
    "cell": "A cell file describes what stands around an arm.",
    "study": "A study file describes a sweep over drawn plants.",
    "plan": "`plan.json`: what `irb2400 plan` promises of a motion, of one operation "
    "(`OperationPlan`) or of a whole program (`ProgramPlan`).",
    "trajectory": "`trajectory.csv`: the motion, a row every few milliseconds.",
    "program": "`program.json`: the operations of a CAM program, and which `irb2400 plan` planned.",
    "rotation_map": "`rotation_map.json`: what other tool rotations would bring "
    "(`irb2400 plan --map`).",
    "placement": "`placement.json`: where `irb2400 place` puts a part (`PartPlacement`) or an arm "
    "on its rail (`RailPlacement`).",
    "simulation": "`simulation.json`: how well a controller followed (`irb2400 simulate`); "
    "`log.csv` beside it is a log like any other.",
    "case": "`cases.parquet`, `cases.jsonl`: the cases of `irb2400 sweep`.",
    "findings": "`findings.json`: what `irb2400 diagnose` found.",
    "closed_loop": "`closed_loop.json`: what the findings are worth to a controller "
    "(`irb2400 diagnose --close-loop`).",
    "watch": "`watch.json`: what `irb2400 watch` saw.",
    "identification": "`identification.json`: the numbers of an arm, and how surely, from "
    "`irb2400 identify`.",
    "covariance": "`covariance.json`: of these numbers, together.",
    "validation": "`validation.json`: how well a robot file predicts logs (`irb2400 validate`).",
    "excitation": "`excitation.json`: what a motion of `irb2400 excite` promises to show, to tell "
    "effects apart (`SeparatingMotion`) or to identify by (`IdentifyingMotion`).",
    "verification": "`verification.json`: whether a C package of `irb2400 codegen` computes what "
    "the controller says.",
}
EXAMPLES = Path(__file__).parents[1] / "examples"
PACKAGES = [name for name in irb.__all__ if isinstance(getattr(irb, name), types.ModuleType)]


def write(folder: Path) -> list[Path]:
    """All pages; only those that have changed are touched, so that a build stays quick."""
    folder.mkdir(exist_ok=True)
    draw_effects(folder / "effects")
    pages = {
        "effects": effects,
        "files": files,
        "commands": commands,
        "api": api,
        "words": words,
        "examples": examples,
    }
    return [_written(folder / f"{name}.md", make) for name, make in pages.items()]


def draw_effects(folder: Path) -> None:
    """A figure of every effect; those that are there stay."""
    folder.mkdir(parents=True, exist_ok=True)
    for kind in LIBRARY:
        path = folder / f"{kind}.svg"
        if not path.is_file():
            effect_figure(kind)[0].savefig(path, metadata={"Date": None})


def _written(path: Path, make: Callable[[], str]) -> Path:
    text = make()
    if not path.is_file() or path.read_text() != text:
        path.write_text(text)
    return path


def effects() -> str:
    """One section an effect, with its figure."""
    text = [
        "# Effects",
        "",
        "What a model may lack. `irb2400 explain KIND` says the same, and with ",
    ]
    text[-1] += "`--out DIR` shows it."
    text.append("")
    for kind in LIBRARY:
        found = explain(kind)
        text += [f"## {kind}", "", _plain(found["sentence"]).capitalize() + ".", ""]
        text += [f"![{kind}](effects/{kind}.svg)", ""]
        text += ["```text", found["law"], "```", "", f"Acts {found['acts_where']}.", ""]
        if found["parameters"]:
            text += ["| parameter | unit | meaning |", "| --- | --- | --- |"]
            text += [
                f"| `{p['name']}` | {_cell(p['unit'] or '')} | {_cell(p['meaning'])} |"
                for p in found["parameters"]
            ]
            text.append("")
        if found["look_alikes"]:
            text += ["Taken for it:", ""]
            for other in found["look_alikes"]:
                apart = other["told_apart_by"] or other["measure_else"] or "nothing known"
                text.append(f"- `{other['kind']}`; told apart by: {_plain(apart)}")
            text.append("")
    return "\n".join(text)


def files() -> str:
    """One section a file, one table a table of it."""
    text = [
        "# Files",
        "",
        "Every key of the files that are written by hand (TOML) and of those that are written for "
        "other programs (JSON, CSV). `irb2400 schema robot > robot.schema.json` gives the same as "
        "JSON Schema; an editor uses it where the first line of the file is "
        "`#:schema robot.schema.json`. What the numbers mean stands in [planning](../planning.md), "
        "[diagnosis](../diagnosis.md) and [watching](../watching.md); logs in [logs](../logs.md).",
        "",
    ]
    for name in FILES:
        schema = schema_of(name)
        text += [f"## {_title(name)} file", "", SENTENCES[name], ""]
        if "patternProperties" in schema:
            text += [_plain(" ".join(schema["description"].split())), ""]
        if "properties" in schema:
            text += _table(schema)
        for table, own in sorted(schema.get("$defs", {}).items()):
            if own.get("properties"):
                text += [f"### {name}: {table}", "", *_table(own)]
    return "\n".join(text)


def _title(name: str) -> str:
    return name.replace("_", " ").capitalize()


def _table(schema: dict[str, Any]) -> Iterator[str]:
    yield "| key | value | default |"
    yield "| --- | --- | --- |"
    needed = set(schema.get("required", []))
    for key, one in schema["properties"].items():
        default = "needed" if key in needed else _cell(_short(one.get("default", "")))
        yield f"| `{key}` | {_cell(_kind(one))} | {default} |"
    yield ""


def _kind(one: dict[str, Any]) -> str:
    """The type of a value in words, its description behind it."""
    told = one.get("description", "")
    return f"{_type(one)}: {told}" if told else _type(one)


def _type(one: dict[str, Any]) -> str:
    if "const" in one:
        return f"`{one['const']}`"
    if "enum" in one:
        return " or ".join(f"`{value}`" for value in one["enum"])
    if "$ref" in one:
        return one["$ref"].split("/")[-1]
    for key in ("anyOf", "oneOf"):
        if key in one:
            kinds = dict.fromkeys(_type(part) for part in one[key] if part.get("type") != "null")
            return " or ".join(kinds) if len(kinds) < 6 else "one of the tables below"
    if one.get("type") == "array":
        inner = one.get("items") or (one.get("prefixItems") or [{}])[0]
        return f"list of {_type(inner)}"
    return str(one.get("type", "anything"))


def commands() -> str:
    """What every command says of itself."""
    text = ["# Commands", "", "`irb2400 COMMAND --help` prints the same.", ""]
    root = get_command(app)
    for name, command in root.commands.items():  # type: ignore[attr-defined]
        group = getattr(command, "commands", None)
        for own, verb in [(name, command)] if group is None else group.items():
            title = own if group is None else f"{name} {own}"
            context = verb.make_context(title, [], resilient_parsing=True, max_content_width=96)
            context.info_name = f"irb2400 {title}"
            text += [f"## {title}", "", "```text", verb.get_help(context).strip(), "```", ""]
    return "\n".join(text)


def api() -> str:
    """What every package promises in its `__all__`."""
    text = [
        "# API",
        "",
        "What is promised: the names in each package's `__all__`. SI and radians; arrays of one "
        "configuration are (n,), of many (m, n).",
        "",
    ]
    for package in PACKAGES:
        module = getattr(irb, package)
        text += [f"## irb2400_ctrl.{package}", "", _plain(_first(module)), ""]
        for name in sorted(getattr(module, "__all__", [])):
            text += _described(package, name, getattr(module, name))
    return "\n".join(text)


def _described(package: str, name: str, found: Any) -> Iterator[str]:
    if isinstance(found, types.ModuleType) or typing.get_origin(found) is not None:
        return
    yield f"### {package}.{name}"
    yield ""
    if not (inspect.isclass(found) or inspect.isroutine(found)):
        return
    yield "```python"
    yield _signature(name, found)
    yield "```"
    yield ""
    if found.__doc__:
        yield from ("```text", inspect.cleandoc(found.__doc__), "```", "")
    if inspect.isclass(found):
        for own, member in vars(found).items():
            method = inspect.isfunction(member) or isinstance(member, property)
            if method and not own.startswith("_") and member.__doc__:
                line = inspect.cleandoc(member.__doc__).split("\n\n")[0].replace("\n", " ")
                yield f"- `{own}`: {_plain(line)}"
        yield ""


def _signature(name: str, found: Any) -> str:
    try:
        return f"{name}{inspect.signature(found)}"
    except (TypeError, ValueError):
        return name


def words() -> str:
    """The words that the reports explain."""
    text = ["# Words of the reports", ""]
    for word, meaning in sorted(WORDS.items(), key=lambda item: item[0].lower()):
        text += [word, f": {_plain(meaning)}", ""]
    return "\n".join(text)


def examples() -> str:
    """One section an example: its question, and the script that answers it."""
    text = [
        "# Examples",
        "",
        "Short scripts, one question each; they print the answer, and most draw a figure into the "
        "folder they run in: `python examples/control_02_speed.py`. The tests run every one.",
        "",
    ]
    for path in sorted(EXAMPLES.rglob("*.py")):
        code = path.read_text()
        said = " ".join((ast.get_docstring(ast.parse(code)) or "").split())
        question, mark, more = said.partition("?")
        if not mark:
            continue
        text += [f"## {_plain(question)}?", "", _plain(more.strip()), ""]
        text += [f"`examples/{path.relative_to(EXAMPLES).as_posix()}`", ""]
        text += ["<details><summary>The script</summary>", "", "```python", code.rstrip(), "```"]
        text += ["", "</details>", ""]
    return "\n".join(text)


def _first(module: Any) -> str:
    return inspect.cleandoc(module.__doc__ or "").split("\n\n")[0].replace("\n", " ")


def _short(value: object) -> str:
    text = str(value)
    return text if len(text) < 40 else "a table"


def _cell(text: str) -> str:
    return _plain(text.replace("\n", " ")).replace("|", "\\|")


def _plain(text: str) -> str:
    """Without what Markdown would take for its own."""
    for sign in ("*", "<", "["):
        text = text.replace(sign, f"\\{sign}")
    return text
