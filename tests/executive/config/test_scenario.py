import math
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from executive.config.find import find, located, names
from executive.config.mission import load_mission
from executive.config.source import Mark
from executive.config.validate import listed
from executive.core import registry
from executive.core.errors import ConfigError
from executive.core.rig import RigCalibration
from executive.run.fault import FAULT_KIND
from executive.run.resolve import resolve_scenario
from proving.inject import INSTRUMENT as FAULTS


def problems_of(path, **options):
    with pytest.raises(ConfigError) as caught:
        resolve_scenario(path, **options)
    return str(caught.value).splitlines()


def rewritten(folder, old, new, file="scenarios/dark.yaml"):
    path = folder / file
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    return "scenarios/dark.yaml"


def test_a_scenario_is_resolved_with_every_default(folder):
    scenario = resolve_scenario("scenarios/dark.yaml")
    assert (scenario.name, scenario.seed, scenario.tier) == ("dark", 7, "full")
    assert scenario.world.light.sun_elevation == math.radians(35)
    assert scenario.world.mast_height == 1.5
    assert [s.tolerance_m for s in scenario.mission.route()] == [0.03, 0.02]
    assert scenario.of(FAULTS)[0].duration_s == 1200.0
    assert scenario.of(FAULTS)[0].start.progress == 0.4
    assert scenario.rig == RigCalibration()
    assert scenario.tree.name == "go"


def test_what_is_dumped_resolves_to_an_equal_scenario(folder):
    scenario = resolve_scenario("scenarios/dark.yaml", seed=9, overrides=["rig.head.mast_height=1.7 m"])
    (folder / "elsewhere").mkdir()
    dumped = folder / "elsewhere" / "scenario.yaml"
    dumped.write_text(scenario.dump())
    again = resolve_scenario(dumped)
    assert again == scenario
    assert again.dump() == scenario.dump()
    assert again.rig.head.mast_height_m == 1.7


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    x=st.floats(1.5, 15),
    elevation=st.floats(0, 1.5),
    limit=st.floats(1e-3, 1e6),
    tilt=st.floats(-0.5, 1.3),
)
def test_every_float_survives_the_dump_bit_for_bit(folder, x, elevation, limit, tilt):
    scenario = resolve_scenario(
        "scenarios/dark.yaml",
        overrides=[
            f"mission.waypoints.2.x={x!r} m",
            f"world.light.sun_elevation={elevation!r} rad",
            f"time_limit={limit!r} s",
            f"rig.head.tilt_limits=[{tilt!r} rad, 80 deg]",
        ],
    )
    (folder / "dumped.yaml").write_text(scenario.dump())
    assert resolve_scenario("dumped.yaml") == scenario


def test_a_mission_is_a_scenario_with_defaults(folder):
    problems = problems_of("missions/short.yaml", overrides=["backend=plian"])
    assert "the unknown backend" in problems[0]
    assert 'did you mean "plain"?' in problems[0]
    scenario = resolve_scenario("missions/short.yaml", overrides=["backend=plain"])
    assert (scenario.name, scenario.seed, scenario.tier) == ("short", 0, "full")
    assert len(scenario.mission.waypoints) == 3


def test_every_problem_of_a_scenario_is_told_at_once_with_its_place(folder):
    faults = listed(sorted(registry.names(FAULT_KIND)))
    (folder / "scenarios" / "dark.yaml").write_text(
        "scenario: dark\nmission: short\nseed: -1\ntier: ful\nbackend: plain\n"
        "world: {light: {sun_elevaton: 35 deg}, mast_height: 30}\n"
        "faults:\n  - lamp_of: {marker: 2}\n  - lamp_off: {marker: 7}\n    from: {time: 3 m}\n"
        "expect: {outcome: reachd, always: tilt}\ntimelimit: 3 h\n"
    )
    assert problems_of("scenarios/dark.yaml") == [
        "scenarios/dark.yaml:3:7: got -1, expected greater than or equal to 0",
        'scenarios/dark.yaml:4:7: got "ful", expected a tier of plain: full or geometric; '
        'did you mean "full"?',
        'scenarios/dark.yaml:6:17: got the unknown key "sun_elevaton", expected sun_elevation; '
        'did you mean "sun_elevation"?',
        "scenarios/dark.yaml:6:53: got 30 without a unit, expected a length such as '30 mm'",
        f'scenarios/dark.yaml:8:5: got the unknown fault "lamp_of", expected {faults}; '
        'did you mean "lamp_off"?',
        "scenarios/dark.yaml:9:24: got 7, expected less than or equal to 3",
        "scenarios/dark.yaml:10:18: got '3 m' (a length), expected a duration such as '36 s'",
        'scenarios/dark.yaml:11:19: got "reachd", expected reached, safe_hold, help, time_limit or error; '
        'did you mean "reached"?',
        "scenarios/dark.yaml:11:35: got an angle, expected something true or false",
        'scenarios/dark.yaml:12:1: got the unknown key "timelimit", expected scenario, doc, project, '
        "mission, seed, tier, backend, localizer, policy, world, rig, time_limit or ...; "
        'did you mean "time_limit"?',
    ]


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("{x: 3.2 m, y: 0.1 m}", "{x: 32 m, y: 0.1 m}",
         "missions/short.yaml:6:5: got an unreachable way-point, 32.00 m from the lander, expected 1.2 m to 20 m"),  # noqa: E501  (as it is printed)
        ("{x: 3.2 m, y: 0.1 m}", "{x: 0.3 m, y: 0.1 m}",
         "missions/short.yaml:6:5: got an unreachable way-point, 0.32 m from the lander, expected 1.2 m to 20 m"),  # noqa: E501  (as it is printed)
        ("{x: 3.2 m, y: 0.1 m}", "{x: 2.6 m, y: -400 mm}",
         "missions/short.yaml:6:5: got the same place as way-point 0, expected a segment with a length"),
        ("on_track: 30 mm", "on_track: 300 mm",
         "missions/short.yaml:3:22: got on_track 0.3 m with off_track 0.25 m, expected on_track to be less than "  # noqa: E501  (as it is printed)
         "off_track"),
        ("tolerance: 20 mm", "tolerance: 260 mm",
         "missions/short.yaml:7:37: got tolerance 0.26 m with off_track 0.25 m, expected tolerance to be at most "  # noqa: E501  (as it is printed)
         "off_track"),
        ("tree: go", "tree: goo",
         'missions/short.yaml:2:7: got "goo", expected a file or a name in trees/; did you mean "go"?'),
    ],
)  # fmt: skip
def test_an_impossible_mission_is_refused_where_it_says_so(folder, old, new, problem):
    path = rewritten(folder, old, new, "missions/short.yaml")
    assert problem in problems_of(path)


def test_a_missing_mission_is_located_with_a_guess(folder):
    path = rewritten(folder, "mission: short", "mission: shrot")
    assert problems_of(path) == [
        'scenarios/dark.yaml:2:10: got "shrot", expected a file or a name in missions/; did you mean "short"?'
    ]


def test_problems_in_an_option_are_located_in_it(folder):
    problems = problems_of("scenarios/dark.yaml", overrides=["seed=3", "world.light.sun_elevation=20 m"])
    assert problems == ["--set:2:27: got '20 m' (a length), expected an angle such as '0.5 deg'"]
    problems = problems_of("scenarios/dark.yaml", overrides=["world.lihgt.sun_elevation=20 deg"])
    assert problems == [
        '--set:1:1: got the unknown key "lihgt", expected light or mast_height; did you mean "light"?'
    ]
    assert problems_of("scenarios/dark.yaml", overrides=["seed"])[0].startswith("--set:1:1: got")
    assert problems_of("scenarios/dark.yaml", overrides=["seed.x=3"])[0].startswith("--set:1:1: got")


def test_a_tier_that_the_backend_cannot_play_is_refused(folder):
    path = rewritten(folder, "backend: plain", "backend: poor")
    assert problems_of(path, tier="full") == ['--tier:1:1: got "full", expected a tier of poor: geometric']


def test_without_a_tier_the_backends_first_is_meant(folder):
    assert resolve_scenario("scenarios/dark.yaml").tier == "full"
    assert resolve_scenario(rewritten(folder, "backend: plain", "backend: poor")).tier == "geometric"


def test_a_plugin_that_cannot_be_loaded_is_named(folder):
    path = rewritten(folder, "backend: plain", "backend: broken")
    with pytest.raises(
        ConfigError,
        match=r"dark.yaml:4:10: backend broken: .*longarm.backends: broken = third_party_plugin:MISSING",
    ):
        resolve_scenario(path)


@pytest.mark.parametrize(
    ("trigger", "message"),
    [
        ("{}", "got none, expected exactly one of time, progress, waypoint, node, strategy, phase, when"),
        ("{time: 3 s, waypoint: 1}", "got time and waypoint, expected exactly one of"),
        ("{time: 3 s, edge: rise}", "got edge with time, expected it with when"),
        ("{count: 2, time: 3 s}", "got count with time, expected it with one of node, strategy, phase"),
    ],
)
def test_a_fault_starts_in_exactly_one_way(folder, trigger, message):
    path = rewritten(folder, "{progress: 40 %}", trigger)
    assert message in problems_of(path)[0]


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("{progress: 40 %}", '{when: "tlt > 5 deg"}',
         "scenarios/dark.yaml:8:19: got 'tlt', expected a number, a signal or (...); did you mean \"tilt\"?"),
        ("{progress: 40 %}", "{waypoint: 3}",
         "scenarios/dark.yaml:8:22: got way-point 3, expected 0 to 2"),
        ("{progress: 40 %}", "{strategy: back_of}",
         'scenarios/dark.yaml:8:22: got the unknown strategy "back_of", expected back_off'),
        ("lamp_off: {", "led_off: {",
         "scenarios/dark.yaml:7:5: got led_off with the backend plain, which it cannot act in; expected pybullet"),  # noqa: E501  (as it is printed)
        ("lamp_off: {", "daylight: {",
         "scenarios/dark.yaml:9:5: got a duration of daylight, which cannot be taken back; expected no `for`"),  # noqa: E501  (as it is printed)
    ],
)  # fmt: skip
def test_a_fault_that_cannot_act_is_refused_where_it_says_so(folder, old, new, problem):
    (told,) = problems_of(rewritten(folder, old, new))
    assert told.startswith(problem)


def test_a_fault_of_another_tier_is_refused(folder):
    path = rewritten(folder, "lamp_off: {", "daylight: {")
    told = problems_of(path, tier="geometric")
    assert told[0] == (
        "scenarios/dark.yaml:7:5: got daylight with the tier geometric, which it cannot act in; expected full"
    )


def test_files_of_the_working_folder_come_before_the_installed_ones(tmp_path, monkeypatch):
    mark = Mark("f", 1, 1)
    installed, working = tmp_path / "installed", tmp_path / "working"
    monkeypatch.setattr("executive.config.find.INSTALLED", installed)
    for root in (installed, working):
        (root / "trees").mkdir(parents=True)
    (installed / "trees" / "go.yaml").touch()
    assert find("trees", "go", tmp_path, mark, working) == installed / "trees" / "go.yaml"
    (working / "trees" / "go.yaml").touch()
    assert find("trees", "go.yaml", tmp_path, mark, working) == working / "trees" / "go.yaml"
    assert find("trees", "./working/trees/go.yaml", tmp_path, mark, working) == working / "trees" / "go.yaml"


def test_bare_names_are_found_in_folders_within_too(tmp_path, monkeypatch):
    mark = Mark("f", 1, 1)
    monkeypatch.setattr("executive.config.find.INSTALLED", tmp_path / "installed")
    inner = tmp_path / "scenarios" / "tracks"
    inner.mkdir(parents=True)
    (inner / "jam.yaml").touch()
    assert find("scenarios", "jam", tmp_path, mark, tmp_path) == inner / "jam.yaml"
    assert names("scenarios", tmp_path) == ["jam"]
    (tmp_path / "scenarios" / "jam.yaml").touch()
    assert find("scenarios", "jam", tmp_path, mark, tmp_path) == tmp_path / "scenarios" / "jam.yaml"


def test_a_command_may_be_given_a_bare_name(tmp_path, monkeypatch):
    monkeypatch.setattr("executive.config.find.INSTALLED", tmp_path / "installed")
    monkeypatch.chdir(tmp_path)
    mission = tmp_path / "installed" / "missions" / "hop.yaml"
    mission.parent.mkdir(parents=True)
    mission.touch()
    assert located(Path("hop"), "scenarios", "missions").resolve() == mission
    assert located(Path("hip"), "scenarios", "missions") == Path("hip")
    Path("hop").touch()
    assert located(Path("hop"), "scenarios", "missions") == Path("hop")


words = st.sampled_from(
    [
        "scenario",
        "mission",
        "tree",
        "seed",
        "world",
        "faults",
        "from",
        "expect",
        "waypoints",
        "x",
        "30 mm",
        "1 m",
    ]
)
values = st.recursive(
    st.one_of(
        st.none(), st.booleans(), st.integers(), st.floats(allow_nan=False), words, st.text(max_size=5)
    ),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(words, inner, max_size=4)),
    max_leaves=12,
)


@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.dictionaries(words, values, max_size=6))
def test_any_mapping_resolves_or_is_a_config_error(folder, data):
    import json

    (folder / "fuzz.yaml").write_text(json.dumps(data))
    try:
        resolve_scenario("fuzz.yaml", overrides=["backend=plain"])
    except ConfigError as error:
        assert all(p.line >= 1 and p.column >= 1 for p in error.problems)


def test_a_mission_loads_alone(folder):
    assert load_mission(Path("missions/short.yaml")).route()[1].index == 1


def test_inputs_of_the_tree_are_checked_against_its_ports(folder):
    ports = "ports: {route: {type: Route}, pause: {type: duration, default: 1 s}}"
    rewritten(folder, "ports: {route: {type: Route}}", ports, "trees/go.yaml")
    path = rewritten(folder, "tree: go\n", "tree: go\ntree_inputs: {pause: 2 min}\n", "missions/short.yaml")
    assert resolve_scenario(path).inputs == {"pause": 120.0}
    rewritten(folder, "{pause: 2 min}", "{pause: 2 m, puse: 1 s}", "missions/short.yaml")
    assert problems_of(path) == [
        "missions/short.yaml:3:22: got '2 m' (a length), expected a duration such as '36 s'",
        'missions/short.yaml:3:27: got the unknown input "puse" of go, expected route or pause; did you mean "pause"?',  # noqa: E501  (as it is printed)
    ]


@pytest.mark.parametrize(
    ("profile", "problem"),
    [
        ("ramp", 'scenarios/dark.yaml:10:14: got "ramp", expected step, or a mapping'),
        ("{ramp: 3 min}", "scenarios/dark.yaml:10:15: got a ramp of lamp_off, which is there or not"),
        ("{}", "scenarios/dark.yaml:10:14: got none, expected exactly one of ramp"),
        ("{random: {every: 3 min}}", 'scenarios/dark.yaml:10:23: got no "lasts"'),
    ],
)
def test_a_profile_that_cannot_be_is_refused_in_its_place(folder, profile, problem):
    (told,) = problems_of(rewritten(folder, "    for: 20 min", f"    for: 20 min\n    profile: {profile}"))
    assert told.startswith(problem)


def test_a_problem_inside_a_group_is_told_where_it_stands(folder):
    group = "  - group: storm\n    from: {progress: 40 %}\n    faults:\n      - lamp_off: {marker: 7}\n"
    old = "  - lamp_off: {marker: 2}\n    from: {progress: 40 %}\n    for: 20 min\n"
    (told,) = problems_of(rewritten(folder, old, group))
    assert told.startswith("scenarios/dark.yaml:10:28: got 7")


def test_a_group_without_faults_is_refused(folder):
    (told,) = problems_of(rewritten(folder, "lamp_off: {marker: 2}", "group: storm"))
    assert told.startswith("scenarios/dark.yaml:7:5: got a group without a list of faults")
