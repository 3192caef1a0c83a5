"""The processor as far as results depend on it.

OpenBLAS and NumPy choose code for the processor that they run on. The codes add in another order,
so that results differ in their last bits.
"""

from __future__ import annotations

import functools

import numpy as np
import scipy.linalg  # noqa: F401  # loads its own OpenBLAS, which is then among those listed
from threadpoolctl import threadpool_info


@functools.cache
def processor_kernel() -> str:
    """Kernels of linear algebra libraries and instructions of NumPy, such as Haswell X86_V3.

    Two machines of which this is equal give equal files, as far as these libraries are concerned.
    """
    kernels = {str(library.get("architecture")) for library in threadpool_info()} - {"None"}
    extensions = np.show_config(mode="dicts")["SIMD Extensions"]
    found = [*extensions.get("baseline", ()), *extensions.get("found", ())]
    return " ".join([*sorted(kernels), *found[-1:]])
