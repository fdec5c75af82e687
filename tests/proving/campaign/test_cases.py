"""What a case is depends on the campaign and the case's number, and on nothing else."""

from __future__ import annotations

import pytest

from proving.campaign.cases import case_number, prepared, resolved, seed_of
from proving.inject import INSTRUMENT
from tests.proving.campaign.conftest import INLINE, VARY

TWO = {"as_it_is": {}, "slow": {"world.advance": 0.5}}
DEAD = {"harmless": {}, "from": {"time": {"uniform": ["10 s", "90 s"]}}, "name": "dead"}


def values(case):
    return {key: value.data for key, value in case.values.items()}


def test_a_case_is_the_same_whenever_it_is_drawn(load):
    one, again = load(), load()
    forth = [prepared(one, case_number(one, n)).text for n in range(6)]
    back = [prepared(again, case_number(again, n)).text for n in reversed(range(6))]
    assert forth == back[::-1]
    assert len(set(forth)) == 6


def test_another_campaign_seed_makes_other_cases(load):
    one, other = load(), load(seed=4)
    assert case_number(one, 0).seed != case_number(other, 0).seed
    assert values(case_number(one, 0)) != values(case_number(other, 0))


def test_seeds_do_not_collide_in_a_large_campaign():
    assert len({seed_of(1, n) for n in range(10_000)}) == 10_000


def test_varying_one_thing_more_does_not_shift_what_else_is_drawn(load):
    few, more = load(), load(vary=VARY | {"world.pixel_sigma": {"uniform": [0.1, 1.0]}})
    assert values(case_number(few, 2)).items() <= values(case_number(more, 2)).items()


def test_what_is_compared_shares_seed_and_draws(load):
    campaign = load(compare=TWO)
    one, other = case_number(campaign, 6), case_number(campaign, 7)
    assert (one.setting, other.setting, one.draw, other.draw) == ("as_it_is", "slow", 3, 3)
    assert one.seed == other.seed
    assert values(other) == values(one) | {"world.advance": 0.5}


def test_the_grid_is_covered_and_more_runs_only_add_cases(load):
    grid = {"world.pixel_sigma": [0.1, 0.5], "time_limit": ["1 h", "2 h", "3 h"]}
    with pytest.raises(Exception, match='got "time_limit"'):
        load(grid=grid)
    campaign = load(grid={"world.pixel_sigma": [0.1, 0.5], "world.yaw_efficiency": [0.4, 0.5, 0.6]}, runs=2)
    assert campaign.total() == 12
    cells = [values(case_number(campaign, n)) for n in range(12)]
    pairs = [(c["world.pixel_sigma"], c["world.yaw_efficiency"]) for c in cells]
    assert sorted(set(pairs)) == [(s, y) for s in (0.1, 0.5) for y in (0.4, 0.5, 0.6)]
    assert pairs[:6] == pairs[6:]


def test_so_many_faults_are_drawn_beside_the_scenarios_own(load, planted):
    faults = {"number": {"integer": [0, 2]}, "from": [{"harmless": {}}, {"raise_error": {}}, DEAD]}
    own = INLINE | {"faults": [{"frozen_frame": {}, "for": "10 s"}]}
    campaign = load(scenario=own, faults=faults)
    drawn = [resolved(campaign, case_number(campaign, n)).of(INSTRUMENT) for n in range(30)]
    assert {len(each) for each in drawn} == {1, 2, 3}
    assert all(each[0].name == "frozen_frame" for each in drawn)
    assert {fault.name for each in drawn for fault in each[1:]} == {"harmless", "raise_error", "dead"}
    onsets = {fault.start.time for each in drawn for fault in each if fault.name == "dead"}
    assert len(onsets) > 3, "distributions inside an entry are drawn per case"
    assert all(10.0 <= onset <= 90.0 for onset in onsets)


def test_the_parameters_of_a_case_are_told_as_text(load, planted):
    campaign = load(faults={"from": [{"harmless": {}}]}, limits={"mission": "1 h"})
    case = case_number(campaign, 0)
    assert case.parameters["faults"] == "harmless"
    assert case.parameters["mission.segments.off_track"].endswith(" cm")
    assert set(case.parameters) == {"faults", *VARY}
    assert resolved(campaign, case).time_limit_s == 3600.0
