"""A sparse matrix that is put together from dense blocks."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from mgs.core.arrays import Array

Places = NDArray[np.intp]  # of rows and columns


def columns_of(at: Places, count: int) -> Places:
    """Columns (m, count) of unknowns of which the first ones are `at` (m,); -1 where that is."""
    return np.where(at[:, None] < 0, -1, at[:, None] + np.arange(count))


@dataclass(eq=False)
class Entries:
    """Entries of a sparse matrix. What falls on column -1 is left out: its unknown is 0."""

    n_rows: int = 0
    rows: list[NDArray[np.int32]] = field(default_factory=list)
    columns: list[NDArray[np.int32]] = field(default_factory=list)
    values: list[Array] = field(default_factory=list)

    def add(self, rows: Places, columns: Places, values: Array) -> None:
        """Values at rows and columns, all of which are broadcast to the shape of the values."""
        chosen = np.broadcast_to(columns >= 0, values.shape)
        for places, known in ((rows, self.rows), (columns, self.columns)):
            known.append(np.broadcast_to(places.astype(np.int32), values.shape)[chosen])
        self.values.append(values[chosen])

    def blocks(self, rows: Places, at: Places, values: Array) -> None:
        """Blocks (m, r, c) whose upper left corners are at rows (m,) and columns `at` (m,)."""
        r, c = values.shape[1:]
        places = rows[:, None] + np.arange(r)
        self.add(places[..., None], columns_of(at, c)[:, None], values)

    def new_rows(self, count: int, each: int) -> Places:
        """First rows (count,) of blocks of new rows."""
        rows = self.n_rows + each * np.arange(count)
        self.n_rows += each * count
        return rows

    def matrix(self, n_columns: int) -> sp.csc_matrix:
        """The matrix, with the indices of every column in order. The entries are given up."""
        values = np.concatenate(self.values)
        rows, columns = np.concatenate(self.rows), np.concatenate(self.columns)
        self.values, self.rows, self.columns = [], [], []
        made = sp.csc_matrix((values, (rows, columns)), shape=(self.n_rows, n_columns))
        made.sort_indices()
        return made
