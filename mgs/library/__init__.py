"""Gait libraries: from a sweep file to many motion files and one manifest, and how to find one.

sweep.py reads a sweep, points.py turns it into gaits, worker.py makes one gait, cluster.py connects
to the workers, outcomes.py sends them gaits and collects the outcomes, run.py writes these into the
manifest (manifest.py, protected by lock.py), and query.py finds gaits in a library by conditions
(condition.py).
"""

from mgs.library.query import GaitLibrary, LibraryGait

__all__ = ["GaitLibrary", "LibraryGait"]
