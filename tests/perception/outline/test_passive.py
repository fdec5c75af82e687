"""Passive features: exact drawing, the background's fit, and fixes that are right or refused."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter, shift

from executive.core.rig import RigCalibration
from executive.core.types import Window
from perception.outline.passive import PassiveFix, PassiveRefusal, passive_fix
from perception.outline.passive.background import lay_under
from perception.outline.passive.binning import binned, binned_rig
from perception.outline.passive.coverage import coverage
from perception.outline.passive.drawing import Artist, Stands
from perception.outline.passive.hiding import near_first
from perception.outline.passive.solids import rover_solids
from sim_pybullet.projection import scene_views
from sim_pybullet.rover_view import RoverRenderer
from tests.perception.passive_trials import RIG, Wrong, draw, run_trial, scene, site

RNG = np.random.default_rng


def outline(corners):
    return corners, np.roll(corners, -1, axis=0), np.zeros(len(corners), dtype=np.intp)


def polygon(rng, corners=5):
    angle = np.sort(rng.uniform(0, 2 * np.pi, corners))
    return rng.uniform(10, 14, 2) + rng.uniform(1, 8) * np.column_stack([np.cos(angle), np.sin(angle)])


def fix_of(setting, **changes):
    s = replace(setting, **changes)
    return passive_fix(*_arguments(s), s.sun)


def _arguments(s):
    return s.chain, s.images, s.backgrounds, s.windows, s.expectation, s.ground


@pytest.fixture(scope="module")
def setting():
    return draw(15.0, Wrong.NOTHING, RNG(3))


def test_covered_shares_sum_to_a_polygons_area_either_way_round():
    rng = RNG(1)
    for _ in range(50):
        corners = polygon(rng)
        x, y = corners.T
        area = abs(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2
        for order in (1, -1):
            shares = coverage(*outline(corners[::order]), (1, 24, 24))
            assert shares.sum() == pytest.approx(area, abs=1e-3)
            assert shares.min() > -1e-5
            assert shares.max() < 1 + 1e-5


def test_what_sticks_out_of_the_window_is_cut_off():
    corners = np.array([[-3.0, -2.0], [30.0, -2.0], [30.0, 2.5], [-3.0, 2.5]])
    shares = coverage(*outline(corners), (1, 4, 6))[0]
    np.testing.assert_allclose(shares, np.repeat([[1.0], [1.0], [0.5], [0.0]], 6, axis=1), atol=1e-6)


def test_every_facet_faces_away_from_its_solid():
    solids = rover_solids(RigCalibration(), (0.4, 0.9))
    for facet, solid in enumerate(solids.solid):
        middle = solids.solid_vertices(solid).mean(axis=0)
        assert (solids.point_m[facet] - middle) @ solids.normal[facet] > 0


def test_the_track_on_the_near_side_hides_chassis_and_far_track():
    solids = rover_solids(RigCalibration(), (0.0, 0.0))
    left_first = near_first(solids, np.array([0.0, 10.0, 0.05]))
    assert left_first.index(0) < left_first.index(2) < left_first.index(1)
    right_first = near_first(solids, np.array([0.0, -10.0, 0.05]))
    assert right_first.index(1) < right_first.index(2) < right_first.index(0)


def test_the_drawing_covers_what_the_simulator_paints(setting):
    state = setting.expectation.state
    true = scene(setting.body, state.joints_rad, state.head_rad)
    _, picture, sun = site(0)
    renderer = RoverRenderer(RIG, sun, picture._ground.field)
    solids = rover_solids(RIG, state.joints_rad)
    for camera, window in enumerate(setting.windows):
        over_black = np.zeros((window.height, window.width), np.float32)
        over_white = over_black + 1
        view = scene_views(RIG, true)[camera]
        renderer.draw(over_black, true, view, window)
        renderer.draw(over_white, true, view, window)
        painted = 1 - (over_white - over_black)
        sharp = replace(RIG, sensor=replace(RIG.sensor, psf_sigma_px=1e-3, defocus_px_m=0.0))
        chain = setting.chain.of(sharp)
        stands = Stands(setting.body.rotation[None], setting.body.position_m[None], np.array([[0.5, 0.6]]))
        drawn = 1 - Artist(chain, solids, state.head_rad, camera, window).draw(stands).ground[0]
        edge = 4 * np.sqrt(painted.sum())
        assert painted.sum() > 500
        assert np.abs(drawn - painted).sum() < 0.1 * edge  # a tenth of a pixel all along the outline


def test_a_background_is_found_again_through_shift_light_and_noise():
    rng = RNG(2)
    ground = 400 + 30 * gaussian_filter(rng.standard_normal((130, 150)), 1.5) / 0.19
    moved = 0.93 * shift(ground, (0.4, -1.3), order=3, mode="nearest") + 20
    moved[50:80, 60:100] = 150
    image = moved + 0.6 * rng.standard_normal(ground.shape)
    found = lay_under(image, ground + 0.6 * rng.standard_normal(ground.shape), 0.6)
    assert found.problem == ""
    np.testing.assert_allclose(found.shift_px, [-1.3, 0.4], atol=0.05)
    assert found.gain == pytest.approx(0.93, abs=0.02)
    assert found.explained > 0.5


def test_another_places_background_is_refused():
    rng = RNG(3)
    here, there = (400 + 160 * gaussian_filter(rng.standard_normal((130, 150)), 1.5) for _ in range(2))
    assert "background explains" in lay_under(here, there, 0.6).problem


def test_coarser_pixels_show_a_point_at_the_same_place():
    frames = np.zeros((1, 40, 41), np.uint16)
    frames[0, 20, 22] = 400
    coarse, window = binned(frames, Window(101, 51, 41, 40), 2)
    v, u = np.argwhere(coarse[0] > 0)[0]
    camera, fine = binned_rig(RIG, 2).cameras[0], RIG.cameras[0]
    at = (np.array([101 + 22, 51 + 20]) - fine.principal_px) / fine.focal_px
    seen = (np.array([window.u + u, window.v + v]) - camera.principal_px) / camera.focal_px
    np.testing.assert_allclose(seen, at, atol=0.5 / fine.focal_px + 1e-12)
    assert coarse.sum() == pytest.approx(100)


@pytest.mark.parametrize("range_m", [10.0, 20.0])
def test_a_dark_rover_is_found_by_its_outline_within_its_covariance(range_m):
    trial = run_trial(range_m, RNG([5, round(range_m)]))
    assert trial.why == ""
    assert not trial.false
    along, across, _, _, _, yaw = np.abs(trial.error)
    assert along < 0.15
    assert across < 0.015
    assert yaw < np.radians(1.5)


def test_without_a_known_sun_the_shadow_tells_enough(setting):
    found = passive_fix(*_arguments(setting))
    assert isinstance(found, PassiveFix)
    off = found.site_body.position_m - setting.body.position_m
    assert np.linalg.norm(off) < 0.06
    assert np.abs(off / np.sqrt(np.diag(found.covariance)[:3])).max() < 5


def test_a_survey_that_is_20_mm_wrong_is_named():
    assert "surveyed" in run_trial(15.0, RNG(6), Wrong.ELEVATION).why


def test_a_view_of_another_place_is_no_background():
    assert "background" in run_trial(15.0, RNG(7), Wrong.BACKGROUND).why


def test_an_empty_view_shows_no_rover(setting):
    found = fix_of(setting, images=setting.backgrounds)
    assert isinstance(found, PassiveRefusal)


def test_saturated_images_give_no_pose(setting):
    full = [np.full_like(stack, 1023) for stack in setting.images]
    assert isinstance(fix_of(setting, images=full), PassiveRefusal)
    assert not isinstance(fix_of(setting, images=full, backgrounds=full), PassiveFix)


@pytest.mark.parametrize(
    "spoil",
    [lambda s: s[:, :-1], lambda s: s[0], lambda s: s[:0], lambda s: np.where(s > 0, np.nan, 0.0)],
    ids=["cut", "flat", "none", "nan"],
)
def test_images_that_do_not_fit_their_window_are_told_as_got_and_expected(setting, spoil):
    with pytest.raises(ValueError, match=r"images\[0\]: got .* expected"):
        fix_of(setting, images=[spoil(setting.images[0]), setting.images[1]])
