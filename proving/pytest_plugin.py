"""pytest collects scenario files: `pytest scenarios/`, also with `-n 2`; verdicts as of `longarm test`.

Only YAML files with `scenario:` at the top are taken, and only those named as arguments or lying in a folder
that the ini option `longarm_scenarios` names, so that other people's YAML is left alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from proving.engine.server import ForkServer

_SERVER: pytest.StashKey[ForkServer] = pytest.StashKey()


class ScenarioNotGood(Exception):
    """A scenario whose verdict is not good; its text is all that the user needs."""


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("longarm", "scenario files as tests")
    group.addoption("--longarm-tier", help="Replace the tier of every scenario.")
    group.addoption("--longarm-seed", type=int, help="Replace every seed.")
    group.addoption("--longarm-out", default="runs/pytest", help="Where the run folders go.")
    parser.addini("longarm_scenarios", "Folders whose scenarios are collected.", type="paths", default=[])


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    if file_path.suffix not in (".yaml", ".yml") or not _asked_for(file_path, parent):
        return None
    from proving.suite.collect import says_scenario

    return ScenarioFile.from_parent(parent, path=file_path) if says_scenario(file_path) else None


def pytest_sessionfinish(session: pytest.Session) -> None:
    server = session.config.stash.get(_SERVER, None)
    if server is not None:
        server.close()


def _asked_for(file: Path, parent: pytest.Collector) -> bool:
    folders: list[Path] = parent.config.getini("longarm_scenarios")
    return parent.session.isinitpath(file) or any(file.is_relative_to(folder) for folder in folders)


class ScenarioFile(pytest.File):
    """A scenario file: one item, named as the scenario."""

    def collect(self) -> Iterator[pytest.Item]:
        from executive.core.errors import LongarmError
        from proving.suite.collect import one

        config = self.config
        try:
            found = one(self.path, config.getoption("longarm_seed"), config.getoption("longarm_tier"))
        except LongarmError as error:
            raise self.CollectError(str(error)) from None
        yield ScenarioItem.from_parent(self, name=found.scenario.name, collected=found)


class ScenarioItem(pytest.Item):
    """One scenario, run in a child process and judged."""

    def __init__(self, *, collected: Any, **settings: Any) -> None:
        super().__init__(**settings)
        self.collected = collected

    def runtest(self) -> None:
        from proving.engine.supervisor import run_alone
        from proving.judge.verdict import Word
        from proving.suite.run import SuiteOptions, case_of, tested

        option = self.config.getoption
        options = SuiteOptions(
            Path(option("longarm_out")), seed=option("longarm_seed"), tier=option("longarm_tier")
        )
        row = tested(self.collected, run_alone(_server(self.config), case_of(self.collected, options)))
        if row.verdict.word is Word.EXPECTED_FAILURE:
            pytest.xfail(row.verdict.message)  # the scenario itself says `expected_to_fail`, and why
        if not row.verdict.good:
            told = (f"{row.verdict.word}: {row.verdict.message}", f"repeat: {row.repeat}")
            raise ScenarioNotGood("\n".join((*told, f"run folder: {row.folder}")))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        if isinstance(excinfo.value, ScenarioNotGood):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int, str]:
        return self.path, 0, self.name


def _server(config: pytest.Config) -> ForkServer:
    """The process that starts cases, one for this session (with pytest-xdist: for this worker)."""
    from proving.engine.server import ForkServer

    server = config.stash.get(_SERVER, None)
    if server is None or server.gone:
        server = config.stash[_SERVER] = ForkServer()
    return server
