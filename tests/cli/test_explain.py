"""`irb2400 explain`: every effect says what it is, from its own values."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from typer.testing import CliRunner

from irb2400_ctrl.cli.main import app
from irb2400_ctrl.effects import LIBRARY, Search, registry
from irb2400_ctrl.effects.base import COMMON, Acts, Link
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.report import effect_words
from irb2400_ctrl.report.effect_words import excite_line, explain, lines, overview

OWN = '''
"""A hose."""
from typing import ClassVar, Literal

from pydantic import Field

from irb2400_ctrl.effects import Ambiguity, Effect


class LooseHose(Effect):
    """tau_j = k q_j."""

    sentence: ClassVar = "a loose hose swings along"
    example: ClassVar = {"stiffness_Nm_rad": 7.5}
    ambiguity: ClassVar = Ambiguity("hose", splits="take it off", passing=("cable_spring",))

    kind: Literal["loose_hose"] = "loose_hose"
    stiffness_Nm_rad: float = Field(description="stiffness k [Nm/rad]")

    def basis(self, s):
        return self.on(s.q[self.index], s.q.numel())
'''
KINDS = [kind for kind, effect in LIBRARY.items() if registry.users_files([effect]) == []]


def test_yes_and_no_are_written_as_in_a_robot_file() -> None:
    """`False` is no TOML."""
    assert "for example false" in " ".join(lines(explain("time_delay")))


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_explains_itself(kind: str) -> None:
    effect = LIBRARY[kind]
    found = explain(kind)
    assert found["sentence"] == effect.sentence
    assert found["law"].splitlines()[0] in (effect.__doc__ or "").replace("`", "")
    own = {name for name in effect.model_fields if name not in COMMON}
    assert {one["name"] for one in found["parameters"]} == own
    text = " ".join(" ".join(lines(found)).split())
    for one in found["parameters"]:
        # a number without its unit says nothing
        assert one["unit"], one
        assert one["meaning"], one
        assert f"{one['name']} [{one['unit']}]" in text
    alike = {one["kind"] for one in found["look_alikes"]}
    group = {k for k, e in LIBRARY.items() if e.ambiguity.group == effect.ambiguity.group}
    named = {*effect.ambiguity.passing, *effect.ambiguity.lookalikes}
    assert alike >= (group | named) & set(LIBRARY) - {kind}
    assert kind not in alike
    for one in found["look_alikes"]:
        assert one["told_apart_by"] or one["measure_else"], one
        assert f"{one['kind']}: {LIBRARY[one['kind']].sentence}" in text
    json.dumps(found, allow_nan=False)


def test_looking_alike_is_mutual() -> None:
    alike = {kind: {one["kind"] for one in explain(kind)["look_alikes"]} for kind in KINDS}
    for kind, others in alike.items():
        assert all(kind in alike[other] for other in others if other in alike)


def test_every_place_and_every_way_of_searching_has_words() -> None:
    assert set(effect_words.PLACES) == set(get_args(Acts))
    assert set(effect_words.CHAIN) == set(get_args(Link))
    others = {"device", "in_diagnosis", "shows_moving"}
    assert {*effect_words.SEARCH, *others} == {field.name for field in fields(Search)}


def test_the_list_holds_every_kind() -> None:
    assert [one["kind"] for one in overview()] == list(LIBRARY)
    done = CliRunner().invoke(app, ["explain"])
    assert done.exit_code == 0, done.output
    for kind, effect in LIBRARY.items():
        assert any(
            line.startswith(kind) and line.endswith(effect.sentence)
            for line in done.stdout.splitlines()
        )


@pytest.mark.parametrize("name", ["gear_ripple", "Gear-Ripple", " gear ripple "])
def test_a_kind_as_people_write_it(name: str) -> None:
    assert explain(name)["kind"] == "gear_ripple"


def test_an_unknown_kind_names_the_nearest() -> None:
    with pytest.raises(InputError, match=r"no effect 'gear_riple'; did you mean gear_ripple\?"):
        explain("gear_riple")
    with pytest.raises(InputError, match=r"no effect 'rust'; .* `irb2400 explain` lists all"):
        explain("rust")


def test_a_users_own_effect_explains_itself(tmp_path: Path) -> None:
    before = dict(LIBRARY)
    (tmp_path / "hose.py").write_text(OWN)
    arm = tmp_path / "arm.toml"
    CliRunner().invoke(app, ["robot", "new", "--out", str(arm)])
    arm.write_text('effect_files = ["hose.py"]\n' + arm.read_text())
    try:
        done = CliRunner().invoke(app, ["explain", "loose_hose", "--robot", str(arm)])
        assert done.exit_code == 0, done.exception
        assert "loose_hose: a loose hose swings along" in done.stdout
        assert "stiffness_Nm_rad [Nm/rad]: stiffness k; for example 7.5" in done.stdout
        assert "told apart by: take it off" in done.stdout
        # whoever it is taken for names it in turn
        assert "loose_hose" in [one["kind"] for one in explain("cable_spring")["look_alikes"]]
    finally:
        LIBRARY.clear()
        LIBRARY.update(before)


@pytest.mark.parametrize("kind", [*LIBRARY])
def test_every_effect_has_a_figure_of_what_it_does(kind: str) -> None:
    from irb2400_ctrl.report.figures.effect_figure import effect_figure

    figure, joint = effect_figure(kind)
    over_time, over_signal = figure.axes
    added = np.asarray(over_time.lines[0].get_ydata(), dtype=float)
    assert np.nanmax(np.abs(added)) > 1e-3
    assert f"torque {joint} [Nm]" in over_time.get_ylabel()
    assert f" {joint} [" in over_signal.get_xlabel()


def test_a_ripple_is_drawn_with_its_own_amplitude_and_order() -> None:
    from irb2400_ctrl.report.figures.effect_figure import effect_figure

    line = effect_figure("gear_ripple")[0].axes[1].lines[0]
    angle, added = (np.asarray(v, dtype=float) for v in (line.get_xdata(), line.get_ydata()))
    fields = LIBRARY["gear_ripple"].example
    law = fields["amplitude_Nm"] * np.sin(fields["order"] * np.radians(angle) + fields["phase_rad"])
    known = np.isfinite(added)
    np.testing.assert_allclose(added[known], law[known], atol=1e-6)


def test_the_page_of_an_effect(tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["explain", "hysteresis", "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    html = (tmp_path / "report.html").read_text("utf-8")
    assert "What it adds to the torque of joint 2" in html
    assert "What it is taken for" in html


def test_the_motion_that_separates_can_be_asked_for_as_printed() -> None:
    """The line lacked --out, without which excite is refused."""
    assert excite_line("gear_ripple") == "irb2400 excite --for gear_ripple --out next"
    assert excite_line("gear_ripple") in "\n".join(lines(explain("gear_ripple")))
    named = excite_line("hose", "my arm.toml")
    assert named == "irb2400 excite --for hose --robot 'my arm.toml' --out next"
