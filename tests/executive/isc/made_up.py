"""Hypotheses and channels of no robot, for tests of the algorithms."""

from __future__ import annotations

from hypothesis import strategies as st

from executive.isc import Categorical, Channel, Evidence, Gaussian, Hypothesis, Measured

LENGTH = Channel("length", "A number.", "m", Gaussian(0.0, 1.0), lambda seen: None)
WIDTH = Channel("width", "Another number.", "m", Gaussian(1.0, 0.5), lambda seen: None)
COLOUR = Channel("colour", "A category.", "", Categorical(frozenset({"red"}), 0.9, 0.1), lambda seen: None)
CHANNELS = (LENGTH, WIDTH, COLOUR)

LONG = Hypothesis("long", "It is long.", {"length": Gaussian(5.0, 2.0)})
THIN = Hypothesis("thin", "It is thin and blue.", {"width": Gaussian(0.0, 0.2), "colour": COLOUR.nominal})
BLUE = Hypothesis("blue", "It is blue.", {"colour": Categorical(frozenset({"blue"}), 0.8, 0.2)}, prior=2.0)
HYPOTHESES = (LONG, THIN, BLUE)
SILENT = Hypothesis("silent", "As when all is well.", {"length": LENGTH.nominal}, prior=0.5)

numbers = st.floats(-20.0, 20.0)
values = {"length": numbers, "width": numbers, "colour": st.sampled_from(["red", "blue", "green"])}


@st.composite
def evidences(draw: st.DrawFn) -> Evidence:
    """What some of the channels, in any order, may yield at one check."""
    names = draw(st.lists(st.sampled_from(list(values)), unique=True))
    return Evidence(0.0, {name: Measured(draw(values[name]), draw(st.floats(0.0, 2.0))) for name in names})
