"""A third-party plug-in distribution, made on disk and put on the path, as a user would install one."""

import sys
from textwrap import dedent

import pytest

MODULE = """
from dataclasses import dataclass
from pydantic import BaseModel, ConfigDict, Field
from typing import Annotated
from executive.config.backends import BackendSpec
from executive.config.localizers import LocalizerSpec
from executive.run.fault import Fault, FaultSpec
from executive.core.device_spec import DeviceSpec, Quantity
from executive.core.rig import RigCalibration
from executive.core.values import NUMBER
from executive.core.units import Angle, Length, Fraction

class Light(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")
    sun_elevation: Angle = 0.5

class World(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")
    light: Light = Light()
    mast_height: Annotated[Length, Field(gt=0)] = 1.5

class LampOff(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")
    marker: Annotated[int, Field(ge=0, le=3)]
    depth: Fraction = 1.0

DEVICES = ("tracks", "cabin", "head", "cameras", "inclinometer", "tether", "link")
BACKEND = BackendSpec(
    "plain", "For tests.", World, ("full", "geometric"), DEVICES, RigCalibration, lambda request: None
)
POOR = BackendSpec(
    "poor", "A backend without images.", World, ("geometric",), DEVICES, RigCalibration, lambda request: None
)

@dataclass(frozen=True)
class BareRover:
    length_m: float = 0.5
    width_m: float = 0.4
    track_gauge_m: float = 0.3
    speed_m_s: float = 0.1
    tilt_limit_rad: float = 0.4
    tether_limit_n: float | None = None

@dataclass(frozen=True)
class BareRig:
    rover: BareRover = BareRover()

BATTERY = DeviceSpec(
    "battery", "The battery.", object,
    (Quantity("charge", NUMBER, "what is left, 0 to 1", lambda r: r),),
    read=lambda battery: battery.charge,
)
BARE = BackendSpec(
    "bare", "On wheels.", World, ("full", "geometric"), ("drive", "battery"), BareRig, lambda request: None
)
BLIND = LocalizerSpec("blind", "Sees nothing.", ("guess",), lambda request: None, needs=())
LAMP_OFF = FaultSpec("lamp_off", "A lamp goes out.", LampOff, lambda lamp: Fault(), "marker_lost")
DAYLIGHT = FaultSpec(
    "daylight", "Too bright.", LampOff, lambda lamp: Fault(), "poor_view", ("plain",), ("full",), lasting=True
)
"""

POINTS = """
[longarm.backends]
plain = third_party_plugin:BACKEND
poor = third_party_plugin:POOR
bare = third_party_plugin:BARE
broken = third_party_plugin:MISSING
[longarm.devices]
battery = third_party_plugin:BATTERY
[longarm.localizers]
blind = third_party_plugin:BLIND
[longarm.faults]
lamp_off = third_party_plugin:LAMP_OFF
daylight = third_party_plugin:DAYLIGHT
"""


@pytest.fixture
def plugin(tmp_path, monkeypatch):
    """The distribution `third-party-plugin`, installed."""
    site = tmp_path / "site"
    info = site / "third_party_plugin-1.0.dist-info"
    info.mkdir(parents=True)
    (site / "third_party_plugin.py").write_text(MODULE)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: third-party-plugin\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(POINTS)
    monkeypatch.syspath_prepend(str(site))
    yield site
    sys.modules.pop("third_party_plugin", None)


MISSION = """\
mission: short
tree: go
segments: {on_track: 30 mm, off_track: 250 mm}
waypoints:
  - {x: 2.6 m, y: -0.4 m}
  - {x: 3.2 m, y: 0.1 m}
  - {x: 4.0 m, y: 0.2 m, tolerance: 20 mm}
"""

SCENARIO = """\
scenario: dark
mission: short
seed: 7
backend: plain
world: {light: {sun_elevation: 35 deg}}
faults:
  - lamp_off: {marker: 2}
    from: {progress: 40 %}
    for: 20 min
expect:
  outcome: reached
  final_error: {below: 30 mm}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch, plugin):
    """A working folder with a tree, a mission and a scenario that fit together."""
    for name, file, text in [
        ("trees", "go.yaml", "tree: go\nports: {route: {type: Route}}\nroot: {wait: {duration: 5 s}}\n"),
        ("missions", "short.yaml", MISSION),
        ("scenarios", "dark.yaml", SCENARIO),
    ]:
        (tmp_path / name).mkdir()
        (tmp_path / name / file).write_text(dedent(text))
    monkeypatch.chdir(tmp_path)
    return tmp_path
