"""All figures that mgs draws with matplotlib, for `mgs.report` to hand out."""

from mgs.report.canvas import save_figures
from mgs.report.envelope import plot_envelope
from mgs.report.figures import Figures, plot
from mgs.report.motion_plots import MOTION_PLOTS, plot_motion
from mgs.report.picture import picture_strip, write_picture
from mgs.report.servo_sweep import plot_servo_sweep

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
