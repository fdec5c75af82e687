"""What a scenario says about its localizer."""

import pytest

from executive.core.errors import ConfigError
from executive.run.resolve import resolve_scenario
from executive.run.schema import schema


def said(folder, localizer):
    path = folder / "scenarios" / "said.yaml"
    path.write_text(f"scenario: said\nmission: short\nbackend: plain\nlocalizer: {localizer}\n")
    return path


def problem(path, **options):
    with pytest.raises(ConfigError) as caught:
        resolve_scenario(path, **options)
    return str(caught.value).replace(str(path), "said.yaml")


def test_a_name_alone_means_the_default_settings(folder):
    chosen = resolve_scenario(said(folder, "led_stereo")).localizer
    assert chosen.spec.name == "led_stereo"
    assert chosen.settings == chosen.spec.settings()


@pytest.mark.parametrize("written", ["led_stereo", "{led_stereo: {}}", "{led_stereo: {outlines: false}}"])
def test_what_is_resolved_resolves_to_the_same(folder, written):
    first = resolve_scenario(said(folder, written))
    again = folder / "again.yaml"
    again.write_text(first.dump())
    assert resolve_scenario(again).localizer == first.localizer


def test_settings_replace_the_defaults(folder):
    settings = resolve_scenario(said(folder, "{led_stereo: {outlines: false}}")).localizer.settings
    assert (settings.outlines, settings.watch_head) == (False, True)


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("led_sterio", ':4:12: got the unknown localizer "led_sterio"'),
        ("{led_sterio: {}}", ':4:13: got the unknown localizer "led_sterio"'),
        ("{led_stereo: {outlinse: true}}", ':4:26: got the unknown key "outlinse"'),
        ("{led_stereo: {outlines: 3}}", ":4:36: got 3"),
        ("[led_stereo]", ":4:12: got a list of 1, expected the name of a localizer"),
        ("{led_stereo: {}, overhead: {}}", ":4:12: got a mapping, expected the name of a localizer"),
    ],
)
def test_a_wrong_localizer_is_told_at_its_place(folder, written, expected):
    assert expected in problem(said(folder, written))


def test_a_localizer_that_cannot_work_in_the_tier_is_refused(folder):
    path = said(folder, "overhead")
    assert "got overhead with the tier full, in which it cannot work" in problem(path)
    assert resolve_scenario(path, tier="geometric").localizer.spec.name == "overhead"


def test_the_schema_knows_names_and_settings():
    names, one = schema("scenario")["properties"]["localizer"]["anyOf"]
    assert "led_stereo" in names["enum"]
    assert set(one["properties"]["led_stereo"]["anyOf"][0]["properties"]) == {"outlines", "watch_head"}
