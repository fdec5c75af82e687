"""Plug-ins written before keep working: the names they import, and what those mean."""

from __future__ import annotations

import importlib.util
import textwrap
from pathlib import Path

import pytest

from executive.hypotheses import Hypothesis

PLUGIN = """
    from pathlib import Path

    from executive.hypotheses import Hypothesis
    from executive.pool import Strategy
    from executive.testing import check_strategy
    from executive.types import Reason

    STRATEGY = Strategy(
        name="wait_for_light",
        doc="Wait five minutes for the light to come back.",
        tree=Path(__file__).with_suffix(".yaml"),
        answers={Hypothesis.ILLUMINATION_CHANGE: 1.0},
        reasons={Reason.UNSTABLE_IMAGES: 0.5},
        cost_s=330.0,
    )

    check_strategy(STRATEGY)
"""


def test_a_strategy_module_of_old_imports_and_checks_itself(tmp_path: Path) -> None:
    module = tmp_path / "wait_for_light.py"
    module.write_text(textwrap.dedent(PLUGIN))
    module.with_suffix(".yaml").write_text("tree: wait_for_light\nroot: {wait: {duration: 300 s}}\n")
    spec = importlib.util.spec_from_file_location("wait_for_light", module)
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    assert loaded.STRATEGY.answers == {"illumination_change": 1.0}


def test_names_of_hypotheses_are_attributes_in_capitals() -> None:
    assert Hypothesis.SLIP_TURNING == "slip_turning"
    with pytest.raises(AttributeError, match="in capitals"):
        _ = Hypothesis.slip_turning
