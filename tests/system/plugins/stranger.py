"""A plug-in of somebody else with one of every kind, written against `longarm`; copied by the tests."""

import json
from dataclasses import replace
from pathlib import Path

import click
from py_trees import common, decorators
from pydantic import BaseModel, ConfigDict

from executive.testing import BACKEND
from longarm import (
    DURATION,
    LENGTH,
    NUMBER,
    POSE,
    Channel,
    Children,
    ControlNode,
    Decision,
    DeviceReading,
    DeviceSpec,
    Fault,
    FaultSpec,
    FileKind,
    Gaussian,
    Hypothesis,
    In,
    InstrumentSpec,
    Leaf,
    LocalizerSpec,
    Out,
    Outcome,
    Policy,
    Quantity,
    Reason,
    Reporter,
    Signal,
    Strategy,
    ValueAttribute,
    ValueType,
)

MASS = ValueType(
    "mass",
    float,
    "kg",
    attributes={
        "grams": ValueAttribute(NUMBER, lambda kg: 1000.0 * kg),
        "patience": ValueAttribute(DURATION, lambda kg: 100.0 * kg),
    },
)


class WeighSample(Leaf):
    """Weigh what lies in the scoop."""

    outcomes = (Reason.DONE, Reason.DEVICE)
    scoop = In(LENGTH, "width of the scoop", default=0.05)
    sample = Out(MASS, "what was found to be in it")

    def step(self):
        self.sample = 2.0 * self.scoop
        return Outcome(Reason.DONE, "weighed")


class Once(ControlNode):
    """Run the child, and not again once it has succeeded."""

    children = Children.ONE

    def make(self, children, context):
        return decorators.OneShot(context.name, children[0], common.OneShotPolicy.ON_SUCCESSFUL_COMPLETION)


TWIN = replace(BACKEND, name="twin", doc="The fake robot under another name.")
THERMOMETER = DeviceSpec(
    "thermometer", "How warm it is.", object, quantities=(Quantity("celsius", NUMBER, "inside", float),)
)
HEAT = Signal(
    "heat", NUMBER, (DeviceReading,), lambda reading: reading.values.get("celsius"), "how hot it is"
)


class Nothing(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class _Hum(Fault):
    def __init__(self, parameters):
        self.heard = False

    def watch(self, backend):
        self.heard = True

    def took_effect(self):
        return self.heard


HUM = FaultSpec("hum", "Something hums.", Nothing, _Hum, "")


def _bumps(seen):
    return None


BUMPS = Channel("bumps", "Bumps felt since the last fix.", "", Gaussian(0.0, 1.0), _bumps)
ROUGH = Hypothesis("rough_ground", "The ground is rough.", {"bumps": Gaussian(5.0, 2.0)})
LAST_FIRST = Policy("last_first", "The least fitted.", lambda options, situation, memory: Decision(None))


class _Watcher(InstrumentSpec):
    name, doc, keys = "watcher", "Counts what happens.", ("watch",)

    def read(self, source, setting):
        return source.data.get("watch", 0)

    def dump(self, settings):
        return {"watch": settings}


WATCHER = _Watcher()

STRATEGY = Strategy(
    name="sit_still",
    doc="Sit still for a while.",
    tree=Path(__file__).with_name("sit_still.yaml"),
    answers={"rough_ground": 0.5},
    reasons={Reason.NOT_SEEN: 0.5},
    cost_s=20.0,
)


def _check_recipe(source):
    from longarm import ConfigError

    if not isinstance(source.data["recipe"], str):
        raise ConfigError([source.at(("recipe",)).problem("got no name, expected one")])


RECIPE = FileKind("recipe", _check_recipe, lambda: {"type": "object", "required": ["recipe"]})


def _write(folder):
    report = folder / "report.html"
    report.write_text(f"<p>{json.loads((folder / 'recipe.json').read_text())}</p>")
    return report


REPORTER = Reporter("recipe", "The report of a recipe.", _write)


@click.command()
def greet():
    """Say hello.

    Example: longarm greet
    """
    click.echo("hello from outside")


def _overhead(request):
    from executive.testing import OverheadLocalizer

    return OverheadLocalizer(request.devices, request.rig, request.clock)


OVERHEAD_TOO = LocalizerSpec(
    "overhead_too", "The overhead view under another name.", sources=("overhead",), make=_overhead
)


__all__ = [
    "BUMPS",
    "HEAT",
    "HUM",
    "LAST_FIRST",
    "MASS",
    "OVERHEAD_TOO",
    "RECIPE",
    "REPORTER",
    "ROUGH",
    "STRATEGY",
    "THERMOMETER",
    "TWIN",
    "WATCHER",
    "Once",
    "WeighSample",
    "greet",
]
_ = POSE  # imported, not defined here: no second value type of that name
