"""URDFs of bipeds as others write them: made of boxes, with whatever makes a URDF hard to read."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

AXES = {"roll": "1 0 0", "pitch": "0 1 0", "yaw": "0 0 1"}
FULL_LEG = ("hip_yaw", "hip_roll", "hip_pitch", "knee_pitch", "ankle_pitch", "ankle_roll")


@dataclass
class Biped:
    """A biped of boxes; `urdf` writes it. Lengths in units of a leg of about `size` metres."""

    leg: tuple[str, ...] = FULL_LEG
    waist: tuple[str, ...] = ("waist_yaw",)
    arm: tuple[str, ...] = ("shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow_pitch")
    head: tuple[str, ...] = ()
    size: float = 0.7  # [m]
    sole: tuple[float, float] = (0.2, 0.1)  # [m]
    ahead: float = 0.03  # [m] of the sole's centre before the ankle
    extra: list[str] = field(default_factory=list)  # elements to add
    foot_geometry: str | None = None  # in place of the box
    effort: float = 150.0
    velocity: float = 8.0
    root: str = "pelvis"

    @property
    def width(self) -> float:
        """Distance of the hips [m]."""
        return 0.25 * self.size

    def urdf(self) -> str:
        """The text."""
        s = self.size
        parts = [_link(self.root, 6.0 * s, (0.15 * s, 0.3 * s, 0.12 * s), (0.0, 0.0, 0.08 * s))]
        for side, sign in (("left", 1), ("right", -1)):
            parts += self._leg(side, sign)
        above = self.root
        for name in self.waist:
            parts += self._joint(name, above, f"{name}_link", (0, 0, 0.15 * s), 0.5)
            parts.append(_link(f"{name}_link", 0.5 * s, (0.05 * s,) * 3))
            above = f"{name}_link"
        if self.arm or self.head or self.waist:
            parts.append(_fixed("chest_fixed", above, "chest", (0, 0, 0.1 * s)))
            parts.append(_link("chest", 8.0 * s, (0.12 * s, 0.25 * s, 0.3 * s), (0, 0, 0.15 * s)))
        for side, sign in (("left", 1), ("right", -1)) if self.arm else ():
            parts += self._arm(side, sign)
        above = "chest"
        for name in self.head:
            parts += self._joint(name, above, f"{name}_link", (0, 0, 0.35 * s), 0.8)
            parts.append(_link(f"{name}_link", 0.4 * s, (0.1 * s,) * 3, (0, 0, 0.1 * s)))
            above = f"{name}_link"
        return "\n".join(['<robot name="boxes">', *parts, *self.extra, "</robot>"])

    def _leg(self, side: str, sign: int) -> list[str]:
        s, above, parts = self.size, self.root, []
        for i, name in enumerate(self.leg):
            origin = (0.0, 0.5 * sign * self.width, 0.0) if i == 0 else (0.0, 0.0, 0.0)
            if name.startswith("knee") or name.startswith("ankle_pitch"):
                origin = (0.0, 0.0, -0.45 * s)
            limits = (0.0, 2.3) if name.startswith("knee") else (-1.6, 1.6)
            link, joint = f"{side}_{name}_link", f"{side}_{name}"
            parts.append(_revolute(joint, above, link, origin, _axis(name), limits, self))
            if i == len(self.leg) - 1:
                parts.append(self._foot(link))
            elif name.startswith("hip_pitch") or name.startswith("knee"):
                size = (0.06 * s, 0.06 * s, 0.35 * s)
                parts.append(_link(link, 2.0 * s, size, (0, 0, -0.22 * s)))
            else:
                parts.append(_link(link, 0.4 * s, (0.03 * s,) * 3))
            above = link
        return parts

    def _foot(self, link: str) -> str:
        (length, width), s = self.sole, self.size
        box = f'<box size="{length} {width} {0.04 * s}"/>'
        origin = f'<origin xyz="{self.ahead} 0 {-0.08 * s}"/>'
        geometry = self.foot_geometry or box
        collision = f"<collision>{origin}<geometry>{geometry}</geometry></collision>"
        return _link(link, 0.6 * s, None, inside=collision)

    def _arm(self, side: str, sign: int) -> list[str]:
        s, above, parts = self.size, "chest", []
        for i, name in enumerate(self.arm):
            origin = (0.0, sign * 0.2 * s, 0.28 * s) if i == 0 else (0.0, 0.0, 0.0)
            if name.startswith("elbow"):
                origin = (0.0, 0.0, -0.3 * s)
            limits = (-2.4, 0.1) if name.startswith("elbow") else (-2.0, 2.0)
            link = f"{side}_{name}_link"
            parts.append(
                _revolute(f"{side}_{name}", above, link, origin, _axis(name), limits, self)
            )
            long = name.startswith(("elbow", "shoulder_yaw"))
            size = (0.05 * s, 0.05 * s, 0.24 * s) if long else (0.03 * s,) * 3
            parts.append(_link(link, 0.6 * s, size, (0, 0, -0.14 * s if long else 0)))
            above = link
        return parts

    def _joint(
        self, name: str, parent: str, child: str, origin: tuple[float, ...], limit: float
    ) -> list[str]:
        return [_revolute(name, parent, child, origin, _axis(name), (-limit, limit), self)]


def _axis(name: str) -> str:
    return AXES[name.rsplit("_", 1)[1]]


def _revolute(
    name: str,
    parent: str,
    child: str,
    origin: tuple[float, ...],
    axis: str,
    limits: tuple[float, float],
    biped: Biped,
) -> str:
    limit = (
        f'<limit lower="{limits[0]}" upper="{limits[1]}" effort="{biped.effort}" '
        f'velocity="{biped.velocity}"/>'
    )
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{_text(origin)}"/><axis xyz="{axis}"/>{limit}</joint>'
    )


def _fixed(name: str, parent: str, child: str, origin: tuple[float, ...] = (0, 0, 0)) -> str:
    return (
        f'<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{_text(origin)}"/></joint>'
    )


def _link(
    name: str,
    mass: float,
    size: tuple[float, ...] | None,
    centre: tuple[float, ...] = (0.0, 0.0, 0.0),
    inside: str = "",
) -> str:
    around = np.array(size if size is not None else (0.1, 0.06, 0.03))
    moments = mass / 12.0 * ((around**2).sum() - around**2)
    inertia = " ".join(f'i{a}{a}="{m}"' for a, m in zip("xyz", moments, strict=True))
    origin = f'<origin xyz="{_text(centre)}"/>'
    box = f'<geometry><box size="{_text(size)}"/></geometry>' if size is not None else ""
    collision = f"<collision>{origin}{box}</collision>" if box else ""
    return (
        f'<link name="{name}"><inertial>{origin}<mass value="{mass}"/>'
        f'<inertia {inertia} ixy="0" ixz="0" iyz="0"/></inertial>{collision}{inside}</link>'
    )


def _text(values: tuple[float, ...]) -> str:
    return " ".join(repr(float(value)) for value in values)
