"""Machine code is made before it is needed: once an installation, and loaded before cases are forked."""

import subprocess
import sys

PREPARED = """
from perception.localizer.machine_code import prepare
from perception.localizer.localizer import LedStereoLocalizer
from perception.calibration import calibrate
from perception.kernels.compiled import uncompiled
told = []
prepare(told.append)
assert uncompiled() == [], uncompiled()
prepare(told.append)
assert sum("compiling" in line for line in told) <= 1, told
"""
LOADED = """
from perception.localizer import LED_STEREO
from perception.kernels.chain import project
from perception.kernels.gauss_newton import gauss_newton
assert not project.signatures and not gauss_newton.signatures
LED_STEREO.preload()
assert project.signatures and gauss_newton.signatures
"""


def runs(program):
    subprocess.run([sys.executable, "-c", program], check=True, timeout=300)


def test_every_kernel_is_compiled_once_prepared():
    runs(PREPARED)


def test_a_pose_needs_no_compiling_after_preload():
    runs(LOADED)
