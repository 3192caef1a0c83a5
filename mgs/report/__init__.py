"""Figures. The only part of mgs that imports matplotlib."""

from mgs.report.motion_plots import MOTION_PLOTS, plot_motion
from mgs.report.picture import picture_strip, write_picture

__all__ = ["MOTION_PLOTS", "picture_strip", "plot_motion", "write_picture"]
