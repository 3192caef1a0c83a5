"""Meshes of a robot, read from one folder only, reduced and packed for a page.

Reduction by vertex clustering (J. Rossignac and P. Borrel, "Multi-resolution 3D approximations for
rendering complex scenes", 1993): vertices in one cell of a grid become one vertex, and triangles
without area vanish. The grid gets coarser until the mesh is small enough.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.report.page.arrays import packed, packed_codes

MOST_BYTES = 64_000_000  # size of the largest mesh file that is read
MOST_TRIANGLES = 400_000  # largest number of triangles of a mesh that is reduced
KEPT = 60_000  # number of triangles of all meshes of a page together, at most
KEPT_OF_ONE = 4000
CELLS, COARSER = 96, 0.8  # cells along the longest side of the first grid; factor to the next one
Triangles = NDArray[np.int64]


class MeshError(ValueError):
    """A mesh that cannot be shown."""


class Meshes:
    """Meshes by their names in a URDF; each is read once."""

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self._numbers: dict[str, int] = {}
        self._found: list[tuple[Array, Triangles]] = []
        self.problem: str | None = None  # the first one

    def add(self, name: str) -> int:
        """Number of a mesh; raises MeshError if it cannot be shown."""
        if name not in self._numbers:
            try:
                self._found.append(read_mesh(self._folder, name))
            except MeshError as error:
                self.problem = self.problem or str(error)
                raise
            self._numbers[name] = len(self._found) - 1
        return self._numbers[name]

    def packed(self) -> list[dict[str, Any]]:
        """All meshes, small enough for a page."""
        if not self._found:
            return []
        most = min(KEPT_OF_ONE, KEPT // len(self._found))
        return [_packed(*reduced(*mesh, most)) for mesh in self._found]


def read_mesh(folder: Path | None, name: str) -> tuple[Array, Triangles]:
    """Vertices (v, 3) and triangles (t, 3) of a mesh inside a folder.

    Raises:
        MeshError: there is no such file in the folder, or it cannot be read.
    """
    path = find_inside(folder, name)
    if path.stat().st_size > MOST_BYTES:
        raise MeshError(f"{path.name} has more than {MOST_BYTES // 10**6} MB")
    try:
        mesh = coal.MeshLoader().load(str(path), np.ones(3))
    except (RuntimeError, ValueError) as error:
        raise MeshError(f"{path.name} cannot be read as a mesh") from error
    n = mesh.num_tris
    if not 0 < n <= MOST_TRIANGLES:
        raise MeshError(f"{path.name} has {n} triangles, 1 to {MOST_TRIANGLES} are possible")
    triangles = np.array([tuple(mesh.tri_indices(i)[j] for j in range(3)) for i in range(n)])
    return np.array(mesh.vertices(), dtype=np.float64), triangles.astype(np.int64)


def find_inside(folder: Path | None, name: str) -> Path:
    """File of a mesh name, which is a relative path or begins with package:// or model://.

    Raises:
        MeshError: the folder has no such file; links that lead out of the folder do not count.
    """
    if folder is None:
        raise MeshError("no folder of meshes was given (--meshes)")
    scheme, separator, rest = name.partition("://")
    if separator and scheme not in ("package", "model", "file"):
        raise MeshError(f"addresses of the kind {scheme[:20]!r} are not read")
    inside = Path(rest if separator else name)
    root = folder.resolve()
    candidates = [root / inside]
    if separator and len(inside.parts) > 1:
        candidates.append(root / Path(*inside.parts[1:]))
    for path in candidates:
        try:
            real = path.resolve()
            if real.is_relative_to(root) and real.is_file():
                return real
        except (OSError, ValueError, RuntimeError):  # such as a name with a zero byte
            continue
    raise MeshError(f"{folder} does not contain {inside.name[:60]!r} where the URDF names it")


def reduced(vertices: Array, triangles: Triangles, most: int) -> tuple[Array, Triangles]:
    """Mesh with at most about `most` triangles."""
    low = vertices.min(axis=0)
    side = float(np.ptp(vertices, axis=0).max()) or 1.0
    cells = float(CELLS)
    while len(triangles) > most and cells >= 2.0:
        codes = np.floor((vertices - low) / side * cells).astype(np.int64)
        _, inverse = np.unique(codes, axis=0, return_inverse=True)
        inverse = inverse.reshape(-1)
        counts = np.bincount(inverse)
        sums = [np.bincount(inverse, vertices[:, axis]) for axis in range(3)]
        middle = np.column_stack(sums) / counts[:, None]
        kept = inverse[triangles]
        a, b, c = kept.T
        kept = np.unique(kept[(a != b) & (b != c) & (a != c)], axis=0)
        if len(kept) <= most:
            return middle, kept
        cells *= COARSER
    return vertices, triangles[:most]


def _packed(vertices: Array, triangles: Triangles) -> dict[str, Any]:
    used, index = np.unique(triangles, return_inverse=True)
    if len(used) > 65535:  # more than an index of 16 bits can name; a reduced mesh never has them
        raise MeshError("a mesh has too many vertices")
    index = index.reshape(-1, 3)
    return {"vertices": packed(vertices[used]), "triangles": packed_codes(index, "u2")}
