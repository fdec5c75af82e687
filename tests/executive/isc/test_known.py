"""Which hypotheses and channels a robot has."""

from executive.isc import known_channels, known_hypotheses


def names(found):
    return {one.name for one in found}


def test_a_robot_weighs_only_what_its_devices_can_show():
    wheeled = {"drive", "inclinometer"}
    assert names(known_hypotheses()) - names(known_hypotheses(wheeled)) == {"tether_snag", "head_misaligned"}
    assert "tether" not in names(known_channels(wheeled))


def test_a_robot_with_every_device_weighs_everything():
    rover = {"drive", "inclinometer", "tether", "head", "cabin", "cameras", "link"}
    assert known_hypotheses(rover) == known_hypotheses()
    assert known_channels(rover) == known_channels()
