"""Other packages reach these rooms of the core through what their façades offer, not through its modules."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PUBLIC_MODULES = {
    "record": {"events", "truth", "signals"},
    "run": {"app", "resolve", "judging", "schema", "catalogue"},
}
IMPORT = re.compile(r"^\s*from executive\.(record|run)\.(\w+)", re.MULTILINE)


@pytest.mark.parametrize("package", ["proving", "sim_pybullet", "strategies", "perception"])
def test_rooms_are_reached_through_their_facade(package):
    deep = {
        f"{file.relative_to(ROOT)}: executive.{room}.{module}"
        for file in (ROOT / package).rglob("*.py")
        for room, module in IMPORT.findall(file.read_text())
        if module not in PUBLIC_MODULES[room]
    }
    assert deep == set()


@pytest.mark.parametrize("room", PUBLIC_MODULES)
def test_a_facade_offers_what_it_lists_in_order(room):
    facade = __import__(f"executive.{room}", fromlist=["__all__"])
    constants = [name for name in facade.__all__ if name.isupper()]
    classes = [name for name in facade.__all__ if name[0].isupper() and not name.isupper()]
    others = [name for name in facade.__all__ if name[0].islower()]
    assert facade.__all__ == [*sorted(constants), *sorted(classes), *sorted(others)]
    assert all(hasattr(facade, name) for name in facade.__all__)
