"""Figures and pages of motions and studies; the only part of mgs that imports matplotlib."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mgs.report.drawings import (
        MOTION_PLOTS,
        Figures,
        picture_strip,
        plot,
        plot_envelope,
        plot_motion,
        plot_servo_sweep,
        save_figures,
        write_picture,
    )

__all__ = [
    "MOTION_PLOTS",
    "Figures",
    "picture_strip",
    "plot",
    "plot_envelope",
    "plot_motion",
    "plot_servo_sweep",
    "save_figures",
    "write_picture",
]


def __getattr__(name: str) -> object:
    """Import the figures when one of them is first used (PEP 562).

    A page, which draws nothing itself, is made in half the time without matplotlib.
    """
    if name in __all__:
        from mgs.report import drawings

        return getattr(drawings, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
