"""Processes forked after a warm-up have the machine code of a pose."""

import subprocess
import sys

PROGRAM = """
from perception.kernels.chain import project
from perception.kernels.gauss_newton import gauss_newton
from perception.localizer.localizer import LedStereoLocalizer
assert not project.signatures and not gauss_newton.signatures
LedStereoLocalizer.preload()
assert project.signatures and gauss_newton.signatures
"""


def test_the_localizer_loads_what_a_pose_takes_before_cases_are_forked():
    subprocess.run([sys.executable, "-c", PROGRAM], check=True, timeout=300)
