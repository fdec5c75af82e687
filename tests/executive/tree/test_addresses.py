"""Nodes are found by name, by what stands around them, and by number; control flow may be left out."""

from __future__ import annotations

import pytest

from executive.tree.addresses import matches
from executive.tree.catalogue import control_types

SEGMENT = "navigate/selector/mission/for_each/sequence/traverse_segment/sequence/recover"
TREK = f"{SEGMENT}/sequence/trek_to/loop/sequence"
BACK_OFF = f"{SEGMENT}/back_off/sequence"


@pytest.mark.parametrize(
    ("address", "path"),
    [
        ("localise", f"{TREK}/localise"),
        ("localise", f"{BACK_OFF}/localise#2"),
        ("trek_to/localise", f"{TREK}/localise"),
        ("trek_to/loop/sequence/localise", f"{TREK}/localise"),
        ("traverse_segment/trek_to/localise", f"{TREK}/localise"),
        ("back_off/localise", f"{BACK_OFF}/localise#2"),
        ("back_off/localise#2", f"{BACK_OFF}/localise#2"),
        ("back_off/localise#1", f"{BACK_OFF}/localise"),
        ("back_off/doubt_prediction", f"{BACK_OFF}/inflate_prediction"),
        ("doubt_prediction#2", f"{BACK_OFF}/inflate_prediction#2"),
        ("mission/for_each", "navigate/selector/mission/for_each"),
    ],
)
def test_an_address_means_a_node_by_name_and_what_is_around_it(address: str, path: str) -> None:
    assert matches(address, path)


@pytest.mark.parametrize(
    ("address", "path"),
    [
        ("trek_to", f"{TREK}/localise"),
        ("back_off/localise", f"{TREK}/localise"),
        ("back_off/localise#1", f"{BACK_OFF}/localise#2"),
        ("traverse_segment/localise", f"{BACK_OFF}/localise"),  # the strategy's own, not the segment's
        ("navigate/localise", f"{TREK}/localise"),
        ("x/navigate/selector", "navigate/selector"),
        ("local", f"{TREK}/localise"),
    ],
)
def test_an_address_does_not_mean_what_lies_in_another_named_node(address: str, path: str) -> None:
    assert not matches(address, path)


@pytest.mark.parametrize("step", control_types())
def test_a_step_of_any_control_node_may_be_left_out(step: str) -> None:
    assert matches("navigate/localise", f"navigate/{step}/{step}#2/localise")
