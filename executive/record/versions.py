"""The versions that a run's numbers depend on, for its start document."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

BEARING = ("longarm", "numpy", "scipy", "opencv-python-headless", "pybullet", "pybullet-arm64", "py_trees")


def versions(packages: tuple[str, ...] = BEARING) -> dict[str, str]:
    """Version by package, in the order given; packages that are not installed are left out."""
    found = {}
    for package in packages:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found
