"""What docs/plugins.md shows is what works: its files, its commands, its tests, its package."""

import re
import sys
import tomllib
from pathlib import Path

import pytest

from executive.cli import invoke
from executive.core import registry
from tests.system.plugins.conftest import install

PAGE = (Path(__file__).parent.parent / "docs" / "plugins.md").read_text()
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
FILES = {name: text for _, text in BLOCKS if (name := text.split("\n")[0].removeprefix("# ")) and "." in name}
COMMANDS = [line.split() for kind, text in BLOCKS if kind == "sh" for line in text.splitlines()]


MODULES = {Path(name).stem for name in FILES if name.endswith(".py")}


@pytest.fixture
def project(tmp_path, monkeypatch):
    """The page's files in a folder, which is the working folder."""
    folder = tmp_path / "mine"
    (folder / "lib").mkdir(parents=True)
    for name, text in FILES.items():
        (folder / name).write_text(text)
    monkeypatch.chdir(folder)
    yield folder
    for name in [n for n in sys.modules if n in MODULES or n.startswith("longarm_plugins_")]:
        del sys.modules[name]


def test_one_of_each_kind_is_added_and_works(project, capsys):
    for name, *arguments in COMMANDS:
        assert name == "longarm"
        assert invoke(arguments) == 0, (arguments, capsys.readouterr())
        assert "longarm:" not in capsys.readouterr().err


def test_its_tests_pass(project, monkeypatch):
    monkeypatch.syspath_prepend(str(project))
    names = {}
    exec(compile(FILES["test_mine.py"], "test_mine.py", "exec"), names)
    tests = [test for name, test in names.items() if name.startswith("test_")]
    assert len(tests) == 3
    for test in tests:
        test()


def test_its_package_adds_the_same(project, monkeypatch):
    (project / "longarm.yaml").unlink()
    points = tomllib.loads(FILES["pyproject.toml"])["project"]["entry-points"]
    lines = [f"[{group}]\n" + "".join(f"{n} = {v}\n" for n, v in of.items()) for group, of in points.items()]
    install(project, "mine", "".join(lines))
    monkeypatch.syspath_prepend(str(project))
    added = {"backends": "twin", "localizers": "overhead_too", "leaves": "weigh_sample", "files": "recipe"}
    for plural, name in added.items():
        assert name in registry.every(registry.kind_named(plural))
    assert "mass" not in registry.names(registry.kind_named("value_types"))  # mine.leaves adds leaves alone
