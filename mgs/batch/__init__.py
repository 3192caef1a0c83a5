"""Gait libraries: from a sweep file to many motion files and one manifest.

sweep.py reads a sweep, points.py makes its points, worker.py makes one gait of one point, run.py
has Dask's workers make them all and alone writes, manifest.py and lock.py keep what is written.
"""

from mgs.batch.condition import compile_condition
from mgs.batch.lock import locked
from mgs.batch.manifest import GAITS_FOLDER, MANIFEST, Manifest, file_sha256
from mgs.batch.points import Plan, plan_sweep
from mgs.batch.run import Summary, run_batch
from mgs.batch.sweep import Sweep, load_sweep
from mgs.batch.worker import Outcome, Recipe, make_gait

__all__ = [
    "GAITS_FOLDER",
    "MANIFEST",
    "Manifest",
    "Outcome",
    "Plan",
    "Recipe",
    "Summary",
    "Sweep",
    "compile_condition",
    "file_sha256",
    "load_sweep",
    "locked",
    "make_gait",
    "plan_sweep",
    "run_batch",
]
