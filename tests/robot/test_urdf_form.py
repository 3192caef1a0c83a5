"""What urdfdom would pass over without a word is an error that names it, in any robot folder."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from mgs.core.errors import ConfigError
from mgs.core.shipped import shipped_folder
from mgs.robot import load_robot
from mgs.robot.init import init_robot

MASS = '<mass value="0.26"/>'
LIMIT = '<limit lower="-1.0472" upper="1.0472" effort="1.5" velocity="6.2"/>'
AXIS = '<origin xyz="0 0 0.0705"/><axis xyz="0 0 1"/>'
CHANGES = {
    "a misspelt attribute": (MASS, '<mass vale="0.26"/>', "mass has 'vale', which is unknown"),
    "an attribute in capitals": (MASS, '<mass VALUE="0.26"/>', "did you mean 'value'?"),
    "no attribute": (MASS, "<mass/>", "link pelvis: mass has no value"),
    "no mass": (MASS, "", "link pelvis: inertial has no mass"),
    "two masses": (MASS, MASS * 2, "link pelvis: inertial has 2 elements <mass>"),
    "a misspelt element": (MASS, '<mas value="0.26"/>', "did you mean 'mass'?"),
    "a misspelt limit": (LIMIT, LIMIT.replace("lower", "lowr"), "did you mean 'lower'?"),
    "two limits": (LIMIT, LIMIT * 2, "joint waist_yaw has 2 elements <limit>"),
    "a misspelt axis": (AXIS, AXIS.replace("axis", "axes"), "joint waist_yaw has 'axes'"),
    "an axis without numbers": (AXIS, AXIS.replace(' xyz="0 0 1"', ""), "axis has no xyz"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_what_a_parser_would_drop_is_refused(name: str, tmp_path: Path) -> None:
    before, after, message = CHANGES[name]
    shipped = shipped_folder("robots") / "melson"
    text = (shipped / "robot.urdf").read_text()
    assert text.count(before) == 1
    (tmp_path / "robot.urdf").write_text(text.replace(before, after))
    (tmp_path / "robot.yaml").write_bytes((shipped / "robot.yaml").read_bytes())
    with pytest.raises(ConfigError, match=re.escape(message)):
        load_robot(str(tmp_path))
    with pytest.raises(ConfigError, match=re.escape(message)):
        init_robot(tmp_path / "robot.urdf")


def test_elements_of_simulators_are_left_alone(tmp_path: Path) -> None:
    shipped = shipped_folder("robots") / "melson"
    text = (shipped / "robot.urdf").read_text()
    foreign = (
        '<contact friction="1"/><self_collision_checking/>'
        '<shapes><capsule name="shin"/><mass value="none"/></shapes>'
    )
    extended = LIMIT.replace(
        "/>", ' acceleration="9" qdd_max="9"/><safety_controller k_velocity="1"/>'
    )
    text = text.replace(LIMIT, extended).replace("</inertial>", f"</inertial>{foreign}")
    (tmp_path / "robot.urdf").write_text(text)
    (tmp_path / "robot.yaml").write_bytes((shipped / "robot.yaml").read_bytes())
    assert load_robot(str(tmp_path)).mass == pytest.approx(load_robot("melson").mass, rel=1e-12)
