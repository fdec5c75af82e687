"""Packs the folders of files to read and copy into the wheel, all under one name.

In a checkout `trees/`, `missions/` and their like lie at the top, where people look for them. At the top of
somebody's site-packages they would be in everybody's way, so there they lie in `longarm/data/`, where
`executive.config.find` looks too. All else about the package stands in pyproject.toml.
"""

from __future__ import annotations

from setuptools import setup
from setuptools.command.build_py import build_py

DATA = ("trees", "missions", "scenarios", "campaigns", "templates")
TEMPLATES = ("**/*.py", "**/*.md", "**/*.ini", "**/gitignore")  # of `longarm init`; they are copied, not run


class WithData(build_py):
    """Adds each folder of data as a package `longarm.data.<folder>`: YAML files, and all of a template."""

    def finalize_options(self) -> None:
        super().finalize_options()
        packed = {f"longarm.data.{folder}": folder for folder in DATA}
        self.packages = [*(self.packages or []), *packed]
        self.package_dir = {**self.package_dir, **packed}
        files = {name: ["**/*.yaml"] for name in packed}
        files["longarm.data.templates"] += TEMPLATES
        self.package_data = {**self.package_data, **files}


setup(cmdclass={"build_py": WithData})
