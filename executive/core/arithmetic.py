"""The same last bits on every x86-64 processor with AVX2: a record made on one is repeated on another."""

from __future__ import annotations

import os
import platform
import sys

SETTINGS = {"NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR", "OPENBLAS_CORETYPE": "Haswell"}
"""numpy and OpenBLAS sum as the processor they find allows: here, as if each had AVX2 and none AVX-512."""


def settle() -> None:
    """Choose before numpy is loaded, for this process and its children; what the user has set stays.

    Nothing happens on other architectures, nor where numpy is loaded already and has chosen: children then
    choose as their parent did.
    """
    if "numpy" not in sys.modules and platform.machine().lower() in ("x86_64", "amd64"):
        for name, value in SETTINGS.items():
            os.environ.setdefault(name, value)
