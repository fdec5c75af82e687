"""Linear algebra on one thread in every test, as in every run: two workers have two cores.

Threads that wait for each other spin. A singular value decomposition of 600 × 126 took 2.5 s of CPU on two
busy cores, and 0.01 s on one thread.
"""

from __future__ import annotations

import os

for name in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(
        f"{name}_NUM_THREADS", "1"
    )  # of libraries loaded from now on, and of child processes

from executive.core.one_thread import one_thread  # noqa: E402  (the libraries read it once, when loaded)

one_thread()  # of those that plug-ins of pytest have loaded
