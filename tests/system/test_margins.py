"""Rocks that nobody knew of, on the path: whatever comes of it, the rover is not driven beyond the margin."""

from pathlib import Path

import pytest

from executive.run.app import RunOptions, run

MISSION = Path(__file__).parents[2] / "missions" / "first_traverse.yaml"


@pytest.mark.sim
@pytest.mark.parametrize(
    ("seed", "rock"),
    [
        (1, "{at: {x: 4.25 m, y: 0.9 m}, radius: 100 mm}"),  # pushes a rover that turns beside it
        (2, "{at: {x: 3.5 m, y: 0.12 m}, radius: 120 mm}"),
        (3, "{at: {x: 4.2 m, y: 0.8 m}, radius: 60 mm}"),
    ],
)
def test_a_rock_on_the_path_is_passed_or_the_rover_holds_within_the_margin(seed, rock, tmp_path):
    options = RunOptions(
        seed, tmp_path / "run", "geometric", (f"world.obstacles=[{rock}]", "time_limit=6 h"), bar=False
    )
    result = run(MISSION, options).result
    assert result.outcome in ("reached", "help", "safe_hold")
    assert result.truth.driven_beyond_off_track_m == 0.0
    assert result.truth.max_tilt_deg < 25.0
    assert "back_off" in {row.name for row in result.strategies}
