"""In-situ classification: predict, compare, weigh hypotheses, extrapolate (paper, section 3.2).

A hypothesis and an evidence channel are specs that are registered; the classification is given them, and no
algorithm here knows one by name but `NOMINAL`.
"""

from executive.isc.assessment import Assessment
from executive.isc.bank import NOMINAL, Evidence, HypothesisBank, Weights
from executive.isc.classification import Classification
from executive.isc.comparison import Comparison, Innovation, SinceFix
from executive.isc.doubt import Doubt
from executive.isc.known import (
    hypothesis_names,
    known_channels,
    known_hypotheses,
)
from executive.isc.likelihoods import Categorical, Gaussian, Likelihood, Measured
from executive.isc.readings import Readings, Sensed
from executive.isc.specs import Channel, Concern, Hypothesis

__all__ = [
    "NOMINAL",
    "Assessment",
    "Categorical",
    "Channel",
    "Classification",
    "Comparison",
    "Concern",
    "Doubt",
    "Evidence",
    "Gaussian",
    "Hypothesis",
    "HypothesisBank",
    "Innovation",
    "Likelihood",
    "Measured",
    "Readings",
    "Sensed",
    "SinceFix",
    "Weights",
    "hypothesis_names",
    "known_channels",
    "known_hypotheses",
]
