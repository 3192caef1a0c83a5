"""Gait libraries: from a sweep file to many motion files and one manifest, and how to find one.

sweep.py reads a sweep, points.py makes its points, worker.py makes one gait of one point, run.py
has Dask's workers make them all and alone writes, manifest.py and lock.py keep what is written,
query.py looks into a library with the conditions of condition.py.
"""

from mgs.library.query import GaitLibrary, LibraryGait

__all__ = ["GaitLibrary", "LibraryGait"]
