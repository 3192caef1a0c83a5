"""Self-contained pages (HTML) that show motions: moving robot, verdict, plots and origin.

A page works from disk without a network. Its parts:

- `arrays`: numbers of a motion as base64 text;
- `shapes`, `meshes`: what the robot looks like;
- `motion_data`, `replay_data`, `verdict_data`: everything that a page shows of one motion;
- `html`: the page itself, from the files in `assets`;
- `write`: pages of motion files.
"""

from mgs.report.page.write import PageOptions, write_page

__all__ = ["PageOptions", "write_page"]
