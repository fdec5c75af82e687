"""The shapes of mission and scenario files. Floats are SI inside; files carry units."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any

from pydantic import Field

from executive.config.validate import Strict
from executive.core.types import Point, Segment
from executive.core.units import Duration, Length

DEFAULT_LOCALIZER = "led_stereo"
Name = Annotated[str, Field(min_length=1, max_length=100)]
Margin = Annotated[Length, Field(gt=0)]


class Margins(Strict):
    """Margins of every segment that does not say otherwise (paper, section 3.1)."""

    on_track: Annotated[Margin, Field(description="beside the line; within it nothing is corrected")] = 0.030
    off_track: Annotated[Margin, Field(description="beside the line; beyond it nothing is driven")] = 0.250
    tolerance: Annotated[Margin, Field(description="radius of the zone that counts as reached")] = 0.030


class Waypoint(Strict):
    """A point of the path in `site`; its margins are those of the segment that ends here."""

    x: Annotated[Length, Field(description="away from the lander")]
    y: Annotated[Length, Field(description="to the left, seen from the lander")]
    on_track: Annotated[Margin | None, Field(description="instead of the mission's")] = None
    off_track: Annotated[Margin | None, Field(description="instead of the mission's")] = None
    tolerance: Annotated[Margin | None, Field(description="instead of the mission's")] = None


class MissionFile(Strict):
    """What ground uplinks: way-points with margins, and the tree that runs them."""

    mission: Annotated[Name, Field(description="its name")]
    doc: Annotated[str, Field(description="a sentence for people")] = ""
    tree: Annotated[Name, Field(description="the tree that runs it: a path or a bare name")] = "navigate"
    segments: Annotated[Margins, Field(description="the margins of every segment")] = Margins()
    waypoints: Annotated[
        tuple[Waypoint, ...], Field(min_length=2, description="the path; the first is where the rover starts")
    ]
    tree_inputs: Annotated[
        dict[str, Any], Field(description="values for further ports of the tree, by name")
    ] = Field(default_factory=dict)

    def margins(self, index: int) -> Margins:
        """The margins of the segment that ends at way-point `index`."""
        point, default = self.waypoints[index], self.segments
        return Margins.model_construct(
            on_track=default.on_track if point.on_track is None else point.on_track,
            off_track=default.off_track if point.off_track is None else point.off_track,
            tolerance=default.tolerance if point.tolerance is None else point.tolerance,
        )

    def route(self) -> tuple[Segment, ...]:
        """The segments between consecutive way-points; segment i ends at way-point i + 1."""
        points = [Point(w.x, w.y) for w in self.waypoints]
        return tuple(
            Segment(start, end, m.on_track, m.off_track, self.zone(index + 1), index, self.zone(index))
            for index, (start, end) in enumerate(pairwise(points))
            for m in (self.margins(index + 1),)
        )

    def zone(self, index: int) -> float:
        """The radius in which way-point `index` counts as reached [m].

        Its tolerance, or the off-track margin of the segment that begins there, where that is narrower: a
        rover that stopped outside of it could not go on.
        """
        tolerance = self.margins(index).tolerance
        following = index + 1
        return (
            min(tolerance, self.margins(following).off_track)
            if following < len(self.waypoints)
            else tolerance
        )


class ScenarioFile(Strict):
    """A mission, a world and a seed. `localizer`, `world` and `rig` are read further on; instruments own
    further keys. Without a `tier`, the backend's first is meant.

    `project` names the project file where it is not that beside the scenario or above it.
    """

    scenario: Annotated[Name, Field(description="its name")]
    doc: Annotated[str, Field(description="a sentence for people")] = ""
    project: Annotated[
        Annotated[str, Field(min_length=1)] | None,
        Field(description="a project file, where it is not that beside the scenario or above it"),
    ] = None
    mission: MissionFile
    seed: Annotated[int, Field(ge=0, lt=2**63, description="what all chance is drawn from")] = 0
    tier: Annotated[Name | None, Field(description="how finely to simulate; else the backend's first")] = None
    backend: Annotated[Name, Field(description="the robot, see `longarm backends`")] = "pybullet"
    localizer: Any = DEFAULT_LOCALIZER
    policy: Annotated[
        Name | None, Field(description="how the pool chooses among strategies (default first_fitted)")
    ] = None
    world: Annotated[dict[str, Any], Field(description="what the backend's world may say")] = Field(
        default_factory=dict
    )
    rig: Annotated[dict[str, Any], Field(description="what the robot has otherwise than as built")] = Field(
        default_factory=dict
    )
    time_limit: Annotated[Duration, Field(gt=0, description="of mission time")] = 24 * 3600.0
