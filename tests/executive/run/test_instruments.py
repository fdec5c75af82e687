"""Instruments: registered, in their order, owners of scenario keys; and a core that runs without any."""

import subprocess
import sys

import pytest
import yaml

from executive.core.errors import ConfigError, PluginError
from executive.run.app import RunOptions, run
from executive.run.instrument import Instrument
from executive.run.instruments import Together, instruments_there_are
from executive.run.resolve import resolve_scenario

PLANTED = """
from pydantic import Field
from executive.config.validate import Strict, parse
from executive.run.instrument import Instrument, InstrumentSpec, Judgement

class Keys(Strict):
    patience: int = Field(default=3, ge=1)

class Counter(Instrument):
    def __init__(self, settings):
        self.left = settings.patience

    def tick(self, now_s):
        self.left -= 1

    def conclude(self):
        return "it was over too soon" if self.left > 0 else None

class Spec(InstrumentSpec):
    name, doc, keys, after = "patience", "Wants to see some ticks.", KEYS, AFTER

    def read(self, source, setting):
        return parse(source, Keys)

    def dump(self, settings):
        return settings.model_dump()

    def make(self, settings, context):
        return Counter(settings)

    def judge(self, settings, records):
        return Judgement(met=False)

SPEC = Spec()
"""
POINTS = "[longarm.instruments]\npatience = planted_plugin:SPEC\n"
SHORT = """\
scenario: short
backend: fake
localizer: overhead
tier: geometric
time_limit: 3 h
mission:
  mission: short
  waypoints: [{x: 2.2 m, y: -0.5 m}, {x: 2.3 m, y: -0.5 m}]
"""


@pytest.fixture
def patience(install):
    """An instrument that owns the key `patience`."""

    def write(keys='("patience",)', after='("expect",)'):
        install(PLANTED.replace("KEYS", keys).replace("AFTER", after), POINTS)

    return write


@pytest.fixture
def short(tmp_path):
    def write(more=""):
        file = tmp_path / "short.yaml"
        file.write_text(SHORT + more)
        return file

    return write


def test_the_judge_comes_after_the_faults():
    names = [spec.name for spec in instruments_there_are()]
    assert names.index("faults") < names.index("expect")


def test_an_instrument_comes_after_those_it_names(patience):
    patience()
    assert [spec.name for spec in instruments_there_are()] == ["faults", "expect", "patience"]


def test_a_key_has_one_owner(patience):
    patience(keys='("faults",)')
    with pytest.raises(PluginError, match='the scenario key "faults" belongs to faults already'):
        instruments_there_are()


def test_a_foreign_instrument_owns_its_key(patience, short):
    patience()
    scenario = resolve_scenario(short("patience: 4\n"))
    assert scenario.of(instruments_there_are()[-1]).patience == 4
    assert yaml.safe_load(scenario.dump())["patience"] == 4


def test_problems_of_an_instruments_key_have_their_place(patience, short):
    patience()
    with pytest.raises(ConfigError, match=r"short\.yaml:9:11: got 0, expected greater than or equal to 1"):
        resolve_scenario(short("patience: 0\n"))


def test_a_key_that_nobody_owns_is_a_problem(short):
    with pytest.raises(ConfigError, match=r'short\.yaml:9:1: got the unknown key "patience"'):
        resolve_scenario(short("patience: 4\n"))


@pytest.mark.parametrize(("patient", "outcome"), [(4, "reached"), (10_000, "invalid")])
def test_an_instrument_ticks_and_has_the_last_word(patience, short, tmp_path, patient, outcome):
    patience()
    done = run(short(f"patience: {patient}\n"), RunOptions(out=tmp_path / "run", bar=False, report=False))
    assert done.result.outcome == outcome
    assert done.exit_code == 1


def test_every_instrument_is_asked_for_its_conclusion():
    class Saying(Instrument):
        def __init__(self, why):
            self.why, self.asked = why, False

        def conclude(self):
            self.asked = True
            return self.why

    several = [Saying("one"), Saying(None), Saying("two")]
    assert Together(several).conclude() == "one; two"
    assert all(each.asked for each in several)


WITHOUT = """
import importlib.metadata, sys
from pathlib import Path

found = importlib.metadata.entry_points
def without(**which):
    every = (point for group in found().groups for point in found(group=group))
    kept = importlib.metadata.EntryPoints(p for p in every if not p.value.startswith("proving"))
    return kept.select(**which)
importlib.metadata.entry_points = without
sys.modules["proving"] = None  # importing it fails

from executive.run.app import RunOptions, run
done = run(Path(sys.argv[1]), RunOptions(out=Path(sys.argv[2]), bar=False))
assert done.result.outcome == "reached", done.result
assert (done.result.expectations, done.result.safety) == ((), ())
sys.exit(done.exit_code)
"""


def test_a_mission_runs_without_proving(short, tmp_path):
    command = [sys.executable, "-c", WITHOUT, str(short()), str(tmp_path / "run")]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    assert (tmp_path / "run" / "report.html").is_file()
