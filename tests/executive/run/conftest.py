"""Plug-ins registered for one test, as an installed package would register them."""

import sys

import pytest


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Puts a distribution with one module on the path: `install(module text, entry points text)`."""
    site = tmp_path / "site"
    info = site / "planted_plugin-1.0.dist-info"

    def write(module, points):
        info.mkdir(parents=True)
        (site / "planted_plugin.py").write_text(module)
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: planted-plugin\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(points)
        monkeypatch.syspath_prepend(str(site))

    yield write
    sys.modules.pop("planted_plugin", None)
