"""Processors differ; what is summed on them does not."""

import os
import platform
import subprocess
import sys

import pytest

FEATURES = """
import executive
from numpy._core._multiarray_umath import __cpu_features__ as features
from executive.core.arithmetic import SETTINGS
print([name for name in SETTINGS["NPY_DISABLE_CPU_FEATURES"].split() if features.get(name)])
"""

pytestmark = pytest.mark.skipif(
    platform.machine() not in ("x86_64", "AMD64"), reason="of x86-64 processors only"
)


def printed(code: str, **environment: str) -> str:
    clean = {
        name: value for name, value in os.environ.items() if "NPY_" not in name and "OPENBLAS" not in name
    }
    return subprocess.check_output(
        [sys.executable, "-c", code], env={**clean, **environment}, text=True
    ).strip()


def test_numpy_does_without_what_only_some_processors_have():
    assert printed(FEATURES) == "[]"


def test_what_the_user_has_chosen_stays():
    code = (
        "import executive, os; print(os.environ['OPENBLAS_CORETYPE'], 'numpy' in __import__('sys').modules)"
    )
    assert printed(code, OPENBLAS_CORETYPE="Nehalem") == "Nehalem False"


def test_these_tests_sum_as_runs_do():
    from numpy._core._multiarray_umath import __cpu_features__ as features

    assert not features.get("X86_V4")
