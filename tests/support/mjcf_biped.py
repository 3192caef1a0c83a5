"""An MJCF biped with what MJCF has and URDF has not: defaults, several joints in a body, `ref`."""

from __future__ import annotations

CUBE = """v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
f 1 3 2
f 1 4 3
f 5 6 7
f 5 7 8
f 1 2 6
f 1 6 5
f 3 4 8
f 3 8 7
f 1 5 8
f 1 8 4
f 2 3 7
f 2 7 6
"""
DEFAULTS = """
  <default>
    <joint damping="0.8" armature="0.02"/>
    <geom density="900" group="1"/>
    <default class="limb"><geom type="capsule" size="0.04"/></default>
    <default class="weak"><joint armature="0.005" frictionloss="0.3"/></default>
  </default>
"""


def mjcf(
    extra: str = "",
    equality: str = "",
    asset: str = '<mesh name="foot" file="foot.obj" scale="0.1 0.05 0.015"/>',
    worldbody: str = "",
    pelvis: str = '<freejoint name="root"/>',
    toes: str = "",
) -> str:
    """The text; a mesh `foot.obj` with the content of `CUBE` belongs beside it."""
    legs = "".join(_leg(side, sign, toes) for side, sign in (("left", 1), ("right", -1)))
    arms = "".join(_arm(side, sign) for side, sign in (("left", 1), ("right", -1)))
    motors = "".join(
        f'<motor joint="{side}_{joint}" gear="50" ctrlrange="-3 3" ctrllimited="true"/>'
        for side in ("left", "right")
        for joint in ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_pitch")
    )
    servos = "".join(
        f'<position joint="{side}_ankle_roll" kp="300" forcerange="-90 90"/>'
        for side in ("left", "right")
    )
    return f"""<mujoco model="biped">
  <compiler angle="degree" autolimits="true"/>
  {DEFAULTS}
  <asset>{asset}</asset>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 0.1"/>
    {worldbody}
    <body name="pelvis" pos="0 0 0.9">
      {pelvis}
      <geom type="box" size="0.08 0.12 0.06" pos="0 0 0.05"/>
      {legs}
      <body name="chest" pos="0 0 0.15">
        <joint name="waist_yaw" axis="0 0 1" range="-40 40"/>
        <geom type="ellipsoid" size="0.1 0.16 0.2" pos="0 0 0.22"/>
        <body name="head" pos="0 0 0.5"><geom type="sphere" size="0.09"/></body>
        {arms}
      </body>
    </body>
  </worldbody>
  <contact><exclude body1="pelvis" body2="left_thigh"/></contact>
  <equality>{equality}</equality>
  <actuator>{motors}{servos}</actuator>
  {extra}
</mujoco>"""


def _leg(side: str, sign: int, toes: str) -> str:
    return f"""
      <body name="{side}_thigh" pos="0 {0.1 * sign} 0" euler="0 0 {5 * sign}" childclass="limb">
        <joint name="{side}_hip_yaw" axis="0 0 1" range="-60 60" pos="0 0 0.02"/>
        <joint name="{side}_hip_roll" axis="1 0 0" range="-35 35"/>
        <joint name="{side}_hip_pitch" axis="0 1 0" range="-100 60" pos="0.01 0 -0.01" ref="3"/>
        <geom fromto="0 0 0 0 0 -0.35"/>
        <body name="{side}_shin" pos="0 0 -0.4" euler="0 0 {-5 * sign}">
          <joint name="{side}_knee" axis="0 1 0" range="0 130"/>
          <geom fromto="0 0 0 0 0 -0.35"/>
          <body name="{side}_foot" pos="0 0 -0.4">
            <joint name="{side}_ankle_pitch" axis="0 1 0" range="-60 50"/>
            <joint name="{side}_ankle_roll" axis="1 0 0" range="-35 35" pos="0 0 -0.01"/>
            <geom type="mesh" mesh="foot" pos="0.03 0 -0.06" contype="0" conaffinity="1"/>
            {toes.format(side=side)}
          </body>
        </body>
      </body>"""


def _arm(side: str, sign: int) -> str:
    outward = "-10 120" if sign > 0 else "-120 10"
    return f"""
        <body name="{side}_upper_arm" pos="0 {0.21 * sign} 0.38" childclass="limb">
          <joint name="{side}_shoulder_pitch" axis="0 1 0" range="-150 90" class="weak"/>
          <joint name="{side}_shoulder_roll" axis="1 0 0" range="{outward}" class="weak"/>
          <geom fromto="0 0 0 0 0 -0.25"/>
          <body name="{side}_forearm" pos="0 0 -0.28">
            <joint name="{side}_elbow" axis="0 1 0" range="-130 3" class="weak"/>
            <geom fromto="0 0 0 0 0 -0.22"/>
          </body>
        </body>"""
