"""The slip law and the soil map."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_pybullet.soil import SOILS, Patch, SmoothField, SoilMap, slip_for, thrust_ratio


@given(st.floats(0.0, 0.96), st.floats(0.001, 0.02))
def test_slip_solves_the_law(ratio: float, shear_m: float) -> None:
    slip = slip_for(ratio, 0.32, shear_m)
    if slip < 1.0:
        assert thrust_ratio(slip, 0.32, shear_m) == pytest.approx(ratio, abs=1e-8)
    else:
        assert thrust_ratio(1.0, 0.32, shear_m) <= ratio


@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_slip_grows_with_the_load_and_is_odd(a: float, b: float) -> None:
    low, high = sorted((a, b))
    assert slip_for(low, 0.32, 0.01) <= slip_for(high, 0.32, 0.01) + 1e-12
    assert slip_for(-a, 0.32, 0.01) == -slip_for(a, 0.32, 0.01)


def test_slip_agrees_with_published_points() -> None:
    """tan(20, 30, 35 deg) / 0.8 with K = 10 mm and L = 340 mm, worked out by bisection elsewhere."""
    for slope_deg, expected in ((20, 0.040), (30, 0.102), (35, 0.236)):
        ratio = math.tan(math.radians(slope_deg)) / 0.8
        assert slip_for(ratio, 0.34, 0.010) == pytest.approx(expected, abs=0.001)


def test_track_spins_where_it_cannot_give_the_thrust() -> None:
    assert slip_for(0.99, 0.32, 0.01) == 1.0
    assert slip_for(5.0, 0.32, 0.01) == 1.0


def test_smooth_field_has_unit_variance_and_its_correlation_length() -> None:
    fields = [SmoothField(0.25, np.random.default_rng(s)) for s in range(200)]
    here = np.array([f.at(3.0, 1.0) for f in fields])
    near = np.array([f.at(3.01, 1.0) for f in fields])
    far = np.array([f.at(5.0, 1.0) for f in fields])
    assert here.std() == pytest.approx(1.0, abs=0.15)
    assert np.corrcoef(here, near)[0, 1] > 0.98
    assert abs(np.corrcoef(here, far)[0, 1]) < 0.25


def test_later_patches_cover_earlier_ones() -> None:
    sand, rock, crust = SOILS["loose_sand"], SOILS["bedrock"], SOILS["crust"]
    patches = (Patch((1.0, 0.0), 0.5, sand), Patch((1.2, 0.0), 0.2, rock))
    soils = SoilMap(crust, patches, np.random.default_rng(0))
    assert soils.at(0.8, 0.0) == sand
    assert soils.at(1.2, 0.0) == rock
    assert soils.at(3.0, 0.0) == crust
    edge = soils.at(0.5, 0.0)
    assert sand.friction < edge.friction < crust.friction


@pytest.mark.parametrize("name", list(SOILS))
def test_yaw_efficiency_scatters_around_that_of_the_soil(name: str) -> None:
    soil = SOILS[name]
    soils = SoilMap(soil, (), np.random.default_rng(1))
    values = np.array([soils.yaw_efficiency(soil, 0.7 * i, 0.4 * i) for i in range(300)])
    assert values.mean() == pytest.approx(soil.yaw_efficiency, abs=soil.yaw_scatter / 2)
    assert values.std() == pytest.approx(soil.yaw_scatter, rel=0.35)
    assert values.min() > 0.0
    assert values.max() <= 1.0
