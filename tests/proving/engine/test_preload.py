"""What is loaded before a case is forked: what its words name, and nothing that another robot needs."""

from __future__ import annotations

from pathlib import Path

import pytest

from proving.engine import Case
from proving.engine.preload import Preloads

ALL = [("backend", "fake"), ("backend", "pybullet"), ("localizer", "led_stereo"), ("localizer", "overhead")]


@pytest.fixture
def loaded():
    return []


@pytest.fixture
def preloads(loaded):
    """Preloads that only note what they load."""
    made = Preloads()
    made._waiting = {key: lambda key=key: loaded.append(key) for key in ALL}
    return made


def worded(text, *overrides):
    return Case("c", Path("c.yaml"), Path("out"), text=text, overrides=overrides)


@pytest.mark.parametrize(
    "text",
    [
        "scenario: s\nbackend: fake\nlocalizer: overhead\n",
        '{"scenario": "s", "backend": "fake", "localizer": "overhead"}',
        "backend: 'fake'  # the pybullet one is slower\nlocalizer: {overhead: {}}\n",
        "localizer:\n  overhead:\n    bias: 1\nbackend: fake\n",
    ],
)
def test_only_the_robot_and_localizer_named_are_loaded(preloads, loaded, text):
    assert preloads.load_for(worded(text))
    assert sorted(loaded) == [("backend", "fake"), ("localizer", "overhead")]


def test_what_another_case_names_is_loaded_when_it_comes_and_nothing_twice(preloads, loaded):
    preloads.load_for(worded("backend: fake\nlocalizer: overhead\n"))
    assert preloads.load_for(worded("backend: pybullet\nlocalizer: led_stereo\n"))
    assert not preloads.load_for(worded("backend: pybullet\nlocalizer: overhead\n"))
    assert sorted(loaded) == ALL


def test_where_nothing_is_named_any_may_be_meant(preloads, loaded):
    preloads.load_for(worded("doc: The localizer waits, the backend fake too.\nmission: m\nwaypoints: []\n"))
    assert sorted(loaded) == ALL


def test_an_override_names_it_as_a_file_does(preloads, loaded):
    preloads.load_for(worded("localizer: overhead\n", "backend=pybullet"))
    assert ("backend", "pybullet") in loaded


def test_a_file_that_is_not_there_is_left_to_the_child(preloads, loaded, tmp_path):
    assert not preloads.load_for(Case("c", tmp_path / "nothing.yaml", tmp_path))
    assert loaded == []


def test_the_shipped_robot_and_localizer_have_something_to_load():
    assert {("backend", "pybullet"), ("localizer", "led_stereo")} <= set(Preloads()._waiting)
