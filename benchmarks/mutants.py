"""Which slips of the pen the tests see: single changes of the source, each run against its tests.

    python benchmarks/mutants.py run build/mutants.jsonl --count 20 --seed 1 [--module guard]
    python benchmarks/mutants.py table build/mutants.jsonl

A mutant is one comparison, sign, number, `and`/`or`, `not` or `min`/`max` changed in a copy of the
package. A test fails, or the tests crash or cannot be loaded, or they do not end in time: told
apart, for the last is no test that sees it. What survives or does not end is printed to be read.
"""

from __future__ import annotations

import argparse
import ast
import json
import multiprocessing
import os
import random
import shutil
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
PACKAGE = "irb2400_ctrl"
APART = multiprocessing.get_context("spawn")
"""each mutant is tested in a process of its own that has nothing of the package yet"""
TIMEOUT = 300.0
"""seconds of one mutant's tests"""
SAID = ("failed", "crashed", "no end", "survived")
"""what may come of a mutant: a test fails, the tests cannot be run, run for ever, or all pass"""
CERTIFIED = (
    "tests/planners/test_cell_bounds.py tests/planners/test_cell_constraints.py "
    "tests/planners/test_cell_parts.py tests/planners/test_certified.py "
    "-k (not random_paths and not share_its and not effects_of and not toppra)"
)
SMOOTH = (
    "tests/planners/test_rate_bounds.py tests/planners/test_rate_limited_law.py "
    "tests/planners/test_smooth_timing.py "
    "-k (not random_paths and not another and not price)"
)
EFFECT_BOUNDS = "tests/planners/test_effect_bounds.py -k (not starts and not little)"
SELECTION = (
    "tests/diagnosis/test_criteria.py tests/diagnosis/test_selection.py "
    "tests/diagnosis/test_selection_steps.py"
)
TARGETS = {
    "codegen/machine_code/build_cache.py": "tests/codegen/test_build_cache.py",
    "sweep/journal.py": "tests/sweep/test_run.py -k (spoiled|no_journal|torn)",
    "reading/text_blocks.py": (
        "tests/hostile/test_text_bounds.py tests/hostile/test_listed_files.py"
    ),
    "reading/bounded_text.py": (
        "tests/hostile/test_text_bounds.py tests/hostile/test_listed_files.py"
    ),
    "trajectory/file.py": "tests/hostile/test_listed_files.py tests/simulation/test_trajectory.py",
    "measurement/csv_table.py": (
        "tests/hostile/test_listed_files.py tests/measurement/test_read_log.py"
    ),
    "measurement/text/csv_pieces.py": (
        "tests/hostile/test_listed_files.py tests/measurement/test_stretch.py"
    ),
    "measurement/stretch.py": "tests/measurement/test_stretch.py",
    "measurement/read_log.py": "tests/measurement/test_read_log.py",
    "measurement/columns/understood.py": (
        "tests/measurement/test_read_log.py tests/measurement/test_log_columns.py "
        "tests/measurement/test_signal_names.py"
    ),
    "measurement/cells.py": (
        "tests/measurement/test_read_log.py tests/measurement/test_log_columns.py"
    ),
    "measurement/columns/column_map.py": (
        "tests/measurement/test_read_log.py tests/measurement/test_log_columns.py"
    ),
    "measurement/columns/signal_names.py": "tests/measurement/test_signal_names.py",
    "measurement/columns/joint_order.py": "tests/measurement/test_ros_bags.py",
    "measurement/time_base.py": "tests/measurement/test_time_base.py",
    "measurement/uniform.py": "tests/measurement/test_uniform.py",
    "model/friction.py": "tests/model/test_friction.py",
    "model/kinematics.py": "tests/model/test_reference_states.py tests/model/test_values.py",
    "model/mass_matrix.py": (
        "tests/model/test_body_frames.py tests/model/test_reference_states.py "
        "tests/model/test_identities.py"
    ),
    "model/newton_euler.py": "tests/model/test_reference_states.py tests/model/test_identities.py",
    "controllers/arm_numbers.py": (
        "tests/controllers/test_tables.py tests/controllers/test_effect_tables.py"
    ),
    "controllers/effect_tables.py": "tests/controllers/test_effect_tables.py",
    "controllers/momentum.py": (
        "tests/controllers/test_consistency.py tests/controllers/test_effect_tables.py"
    ),
    "controllers/guard.py": "tests/controllers/test_guard_steps.py",
    "controllers/guards/consistency.py": "tests/controllers/test_consistency.py",
    "controllers/guards/sample_check.py": "tests/controllers/test_guard_steps.py",
    "codegen/input_guard.py": (
        "tests/codegen/test_parameters_and_names.py tests/codegen/test_package.py"
    ),
    "planners/timing/rate_limited/cell_motion.py": SMOOTH,
    "planners/timing/rate_limited/hyperbolic_motion.py": "tests/planners/test_rate_limited_law.py",
    "planners/timing/rate_limited/output_bounds.py": SMOOTH,
    "planners/timing/rate_limited/rate_limited_law.py": SMOOTH,
    "planners/timing/rate_limited/constrained_outputs.py": SMOOTH,
    "planners/timing/certificate.py": CERTIFIED,
    "planners/timing/motion_limits.py": CERTIFIED,
    "planners/timing/piecewise_constant_law.py": CERTIFIED,
    "planners/timing/time_optimal.py": CERTIFIED,
    "planners/timing/torque_bounds.py": f"tests/planners/test_effect_bounds.py {CERTIFIED}",
    "planners/timing/torque_constraints.py": f"tests/planners/test_effect_bounds.py {CERTIFIED}",
    "planners/timing/two_pass/interpreted.py": "tests/planners/test_interpreted_two_pass.py",
    "planners/enclosure/bernstein.py": "tests/planners/test_bernstein.py",
    "planners/enclosure/cells.py": CERTIFIED,
    "planners/enclosure/complex_disc.py": CERTIFIED,
    "planners/enclosure/parabolas.py": CERTIFIED,
    "planners/enclosure/effect_bounds.py": EFFECT_BOUNDS,
    "planners/clearance/crowd.py": "tests/cell/test_clearance.py tests/cell/test_distances.py",
    "planners/timing/sampled_reference/settled_reference.py": (
        "tests/planners/test_sampled_reference.py"
    ),
    "planners/linking/clearance_plane.py": "tests/planners/test_links.py",
    "diagnosis/preparation/noise_test.py": "tests/diagnosis/test_noise.py",
    "diagnosis/comparison/acceptance.py": "tests/diagnosis/test_acceptance.py",
    "diagnosis/comparison/selection.py": SELECTION,
    "diagnosis/comparison/confidence.py": "tests/diagnosis/test_confidence.py",
    "diagnosis/comparison/criteria.py": SELECTION,
    "diagnosis/estimation/evidence.py": "tests/diagnosis/test_parts.py",
    "planners/enclosure/interval.py": (
        "tests/planners/test_bernstein.py tests/planners/test_effect_bounds.py"
    ),
}
"""module -> its tests"""
SWAPPED: dict[type, type] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq, ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult,
    ast.And: ast.Or, ast.Or: ast.And, ast.In: ast.NotIn, ast.NotIn: ast.In,
}  # fmt: skip
NAMES = {"min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum", "any": "all",
         "all": "any", "argmin": "argmax", "argmax": "argmin", "cos": "sin",
         "sin": "cos"}  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """One change: its line, and the text before and after."""

    module: str
    line: int
    before: str
    after: str
    source: str


def mutants(module: str) -> list[Mutant]:
    """All changes of a module."""
    text = (ROOT / PACKAGE / module).read_text()
    count = sum(1 for _ in _places(ast.parse(text)))
    found = []
    for k in range(count):
        tree = ast.parse(text)
        node, change = list(_places(tree))[k]
        before = ast.unparse(node)
        change()
        found.append(Mutant(module, node.lineno, before, ast.unparse(node), ast.unparse(tree)))
    return found


def _places(tree: ast.Module) -> Iterator[tuple[ast.expr, object]]:
    """Every expression that can be changed, with what changes it."""
    told = {
        id(node)
        for raised in ast.walk(tree)
        if isinstance(raised, ast.Raise | ast.JoinedStr | ast.AnnAssign)
        for node in ast.walk(raised)
    }
    for node in ast.walk(tree):
        # wording is not what is tested here
        if id(node) in told:
            continue
        if isinstance(node, ast.Compare) and type(node.ops[0]) in SWAPPED:
            yield node, lambda n=node: n.ops.__setitem__(0, SWAPPED[type(n.ops[0])]())
        elif isinstance(node, ast.BinOp | ast.BoolOp) and type(node.op) in SWAPPED:
            if not isinstance(getattr(node, "left", None), ast.Constant | ast.JoinedStr):
                yield node, lambda n=node: setattr(n, "op", SWAPPED[type(n.op)]())
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
            yield node, lambda n=node: setattr(n, "value", _other(n.value))
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
            yield node, lambda n=node: setattr(n, "op", ast.UAdd())
        elif isinstance(node, ast.Call):
            called = node.func
            name = getattr(called, "id", getattr(called, "attr", ""))
            if name in NAMES:
                key = "id" if isinstance(called, ast.Name) else "attr"
                yield node, lambda c=called, k=key, v=NAMES[name]: setattr(c, k, v)


def _other(value: float) -> float:
    return value + 1 if isinstance(value, int) else 1.1 * value + 1e-3 * (value == 0)


def outcome(mutant: Mutant, tests: str, timeout: float = TIMEOUT) -> str:
    """What the tests of its module say: one of `SAID`."""
    words, _, chosen = tests.partition(" -k ")
    only = ["-k", chosen.strip("()").replace("|", " or ")] if chosen else []
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / PACKAGE
        # with what is compiled of the other modules: that of the changed one is older than it
        shutil.copytree(ROOT / PACKAGE, copy)
        (copy / mutant.module).write_text(mutant.source)
        tested = APART.Process(target=_test, args=(folder, [*words.split(), *only]))
        tested.start()
        tested.join(timeout)
        if tested.is_alive():
            tested.kill()
            tested.join()
            return "no end"
    return {0: "survived", 1: "failed"}.get(tested.exitcode, "crashed")


def _test(folder: str, words: list[str]) -> None:
    """Run tests on the package in a folder; ends the process with pytest's answer."""
    os.chdir(ROOT)
    os.environ["PYTHONPATH"] = folder
    sys.path.insert(0, folder)
    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    os.dup2(silent, 2)
    import pytest

    end = pytest.main(["-q", "-x", "-n", "0", "-p", "no:cacheprovider", *words])
    package = sys.modules.get(PACKAGE)
    if package is None or not str(package.__file__).startswith(folder):
        end = 3  # another one was tested: said before any change is tried
    # at once: what the tests leave open is nothing here
    os._exit(int(end))


def run(out: Path, count: int, seed: int, only: str) -> None:
    """Draw mutants of every module, run them, append a line each."""
    out.parent.mkdir(parents=True, exist_ok=True)
    for module, tests in TARGETS.items():
        if only not in module:
            continue
        every = mutants(module)
        whole = ast.unparse(ast.parse((ROOT / PACKAGE / module).read_text()))
        said = outcome(Mutant(module, 0, "", "", whole), tests)
        if said != "survived":
            raise SystemExit(f"{module}: without any change its tests say: {said}: {tests}")
        drawn = random.Random(f"{seed} {module}").sample(every, min(count, len(every)))
        for mutant in drawn:
            row = {"module": module, "line": mutant.line, "before": mutant.before,
                   "after": mutant.after, "said": outcome(mutant, tests),
                   "of": len(every)}  # fmt: skip
            with out.open("a") as file:
                file.write(json.dumps(row) + "\n")


def table(files: list[Path]) -> None:
    """What came of the drawn changes, per module, and those that no test failed on."""
    rows = [json.loads(line) for file in files for line in file.read_text().splitlines()]
    print(f"| module | changes | drawn | {' | '.join(SAID)} |\n|{' --- |' * (3 + len(SAID))}")
    for module in dict.fromkeys(row["module"] for row in rows):
        mine = [row for row in rows if row["module"] == module]
        print(f"| {module} | {mine[0]['of']} | {len(mine)} | {_counted(mine)} |")
    print(f"| all | | {len(rows)} | {_counted(rows)} |\n")
    for row in rows:
        if row["said"] in ("survived", "no end"):
            place = f"{row['module']}:{row['line']}"
            print(f"{row['said']}: {place}: {row['before']} -> {row['after']}")


def _counted(rows: list[dict[str, Any]]) -> str:
    """How many of them ended in each way."""
    return " | ".join(str(sum(row["said"] == said for row in rows)) for said in SAID)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("verb", choices=["run", "table"])
    parser.add_argument("files", type=Path, nargs="+")
    parser.add_argument("--count", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--module", default="")
    given = parser.parse_args()
    if given.verb == "run":
        run(given.files[0], given.count, given.seed, given.module)
    else:
        table(given.files)
