"""Tables that a user makes by a call: what cannot be is refused in this project's words."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from pydantic import BaseModel

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import FieldError
from irb2400_ctrl.measurement.columns.column_map import Column, load_column_map
from irb2400_ctrl.robot import Body, Friction
from irb2400_ctrl.simulation import Sensors
from irb2400_ctrl.sweep import Study
from irb2400_ctrl.table import Table


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (lambda: Friction(coulomb_Nm="much"), r"found coulomb_Nm = 'much' .*it has static_Nm"),
        (lambda: Body(mass_kg=1.0), r"Body: found no com_m .*it has mass_kg, com_m"),
        (lambda: Sensors(rate_Hz=-1.0), r"Sensors: found rate_Hz = -1.0"),
        (lambda: Column(file="a", quantity="q", joint=1, unit="m"), r"unit 'm', expected one of"),
        (lambda: LIBRARY["payload"](mass="5 kg"), r"found no mass_kg"),
        (lambda: Study(name="s"), r"Study: found no "),
        (lambda: irb.Robot(name="r"), r"Robot: found no source"),
    ],
)
def test_a_table_that_cannot_be_is_refused_in_plain_words(
    wrong: Callable[[], object], says: str
) -> None:
    with pytest.raises(FieldError, match=says) as error:
        wrong()
    assert "validation error" not in str(error.value)


def test_a_table_is_not_changed_and_no_copy_has_a_field_that_it_lacks() -> None:
    friction = Friction(coulomb_Nm=1.0)
    with pytest.raises(FieldError, match=r"an assignment to coulomb_Nm.*model_copy"):
        friction.coulomb_Nm = 2.0  # type: ignore[misc]
    with pytest.raises(FieldError, match=r"found coulomb = 2.0 \(no such field\); it has static"):
        friction.model_copy(update={"coulomb": 2.0})
    assert friction.model_copy(update={"coulomb_Nm": 2.0}).coulomb_Nm == 2.0


def test_every_table_of_a_file_that_a_user_writes_is_such_a_table() -> None:
    def all_below(table: type[BaseModel]) -> set[type[BaseModel]]:
        return {table}.union(*map(all_below, table.__subclasses__()))

    own = {table for table in all_below(BaseModel) if table.__module__.startswith("irb2400_ctrl.")}
    raw = {t for t in own if not issubclass(t, Table) and ".formats." not in t.__module__}
    assert raw == set()


def test_a_wrong_column_map_says_its_problems_one_by_one(tmp_path) -> None:
    path = tmp_path / "map.toml"
    path.write_text(
        '[[columns]]\nfile = "a"\nquantity = "q"\njoint = 1\nunit = "degrees"\n'
        '[[columns]]\nfile = "b"\nquantity = "tau"\njoint = 1\nunit = "Nm"\nfaktor = 2.0\n'
    )
    with pytest.raises(irb.errors.InputError) as error:
        load_column_map(path)
    told = str(error.value)
    assert "columns[1]: unit 'degrees', expected one of rad, deg, rev" in told
    assert "columns[2].faktor: unknown key; did you mean factor?" in told
    assert "Value error" not in told
    assert "at least 1" not in told
