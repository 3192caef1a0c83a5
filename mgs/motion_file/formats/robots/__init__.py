"""Formats that robots and their motion players load."""

from mgs.motion_file.formats.format import Format

ROBOTS: tuple[Format, ...] = ()
