"""Visual meshes stay where they were, by name, and no command needs their files."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from mgs.robot.init import init_robot
from tests.support.bipeds import Biped

VISUAL = (
    '<visual><origin xyz="0.01 0.02 0.03" rpy="0.1 0.2 0.3"/><geometry>'
    '<mesh filename="package://look/{name}.stl" scale="0.001 0.001 0.001"/></geometry>'
    '<material name="red"><color rgba="1 0 0 1"/></material></visual>'
)
FIXED = (
    '<link name="badge">' + VISUAL.format(name="badge") + "</link>"
    '<joint name="badge_fixed" type="fixed"><parent link="chest"/><child link="badge"/>'
    '<origin xyz="0.1 0 0.2" rpy="0 0 1.5"/></joint>'
)


def placed(urdf: str) -> dict[str, tuple[np.ndarray, str]]:
    """Place of each visual mesh in the world at the zero posture, by Pinocchio, and its scale."""
    model = pin.buildModelFromXML(re.sub(r"<visual>.*?</visual>", "", urdf, flags=re.DOTALL))
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    found = {}
    for link in ElementTree.fromstring(urdf).findall("link"):
        frame = data.oMf[model.getFrameId(link.get("name", ""))]
        for visual in link.findall("visual"):
            origin, mesh = visual.find("origin"), visual.find("geometry/mesh")
            assert origin is not None and mesh is not None
            xyz, rpy = (np.array(origin.get(k, "").split(), dtype=float) for k in ("xyz", "rpy"))
            pose = frame * pin.SE3(pin.rpy.rpyToMatrix(rpy), xyz)
            found[mesh.get("filename", "")] = pose.homogeneous, mesh.get("scale", "")
    return found


def test_visual_meshes_stay_in_their_places_without_their_files(tmp_path: Path):
    biped = Biped(extra=[FIXED]).urdf()
    for link in ("chest", "left_knee_pitch_link"):
        biped = biped.replace(f'<link name="{link}">', f'<link name="{link}">{VISUAL}'.replace(
            "{name}", link))  # fmt: skip
    path = tmp_path / "biped.urdf"
    path.write_text(biped)
    cleaned = init_robot(path).urdf
    assert 'rgba="1 0 0 1"' in cleaned
    before, after = placed(biped), placed(cleaned)
    assert before.keys() == after.keys() and len(after) == 3
    for name, (pose, scale) in after.items():
        assert scale == before[name][1]
        np.testing.assert_allclose(pose, before[name][0], atol=1e-9)
