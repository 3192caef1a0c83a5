"""A command gives the same bytes whatever threads, hash seed and locale the process has."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mgs.motion_file import read_motion

SETTINGS: list[dict[str, str]] = [
    {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONHASHSEED": "0", "LC_ALL": "C"},
    {"OMP_NUM_THREADS": "4", "OPENBLAS_NUM_THREADS": "4", "PYTHONHASHSEED": "9",
     "LC_ALL": "tr_TR.UTF-8"},
]  # fmt: skip
MORE = [
    {"OMP_NUM_THREADS": threads, "OPENBLAS_NUM_THREADS": threads, "PYTHONHASHSEED": seed,
     "LC_ALL": locale}
    for threads, seed, locale in [
        ("2", "1", "C.UTF-8"), ("4", "2", "de_DE.UTF-8"), ("1", "3", "C"), ("2", "4", "C"),
        ("4", "5", "C"), ("1", "6", "C.UTF-8"), ("2", "7", "C"), ("4", "8", "C"),
    ]
]  # fmt: skip


def digest(gait: str, folder: Path, settings: dict[str, str]) -> str:
    """Hash of the motion file of a gait, made by a process with these environment variables."""
    path = folder / "a.mcap"
    subprocess.run(
        [sys.executable, "-m", "mgs", "generate", gait, "-o", str(path), "--force"],
        env={**os.environ, **settings}, check=True, capture_output=True,
    )  # fmt: skip
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_threads_hash_seed_and_locale_make_no_difference(tmp_path: Path) -> None:
    assert len({digest("melson/bow", tmp_path, settings) for settings in SETTINGS}) == 1


@pytest.mark.slow
@pytest.mark.parametrize("gait", ["melson/walk_5cm", "coman/walk"])
def test_more_settings_make_no_difference(gait: str, tmp_path: Path) -> None:
    assert len({digest(gait, tmp_path, settings) for settings in (*SETTINGS, *MORE)}) == 1


@pytest.mark.slow
def test_kernels_of_openblas_differ_in_the_last_bits_alone(tmp_path: Path) -> None:
    """As docs/security.md says; 1e-12 rad is far below what a servo resolves."""
    has = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    if "avx2" not in has:
        pytest.skip("the kernels need a processor with AVX2")
    kernels = ["Haswell", "Zen", "Prescott", *(["SkylakeX"] if "avx512f" in has else [])]
    files, q = {}, {}
    for kernel in kernels:
        settings = {"OPENBLAS_CORETYPE": kernel}
        files[kernel] = digest("melson/walk_5cm", tmp_path, settings)
        q[kernel] = read_motion(tmp_path / "a.mcap").q
    assert files["Haswell"] == files["Zen"]
    assert max(np.abs(q[kernel] - q["Haswell"]).max() for kernel in kernels) < 1e-12
