"""Faults of a scenario: entries, triggers, profiles, and the schedule that injects them."""

from proving.inject.entries import RESERVED, ResolvedFault
from proving.inject.instrument import INSTRUMENT
from proving.inject.onsets import Sightings
from proving.inject.triggers import PHASES

__all__ = ["INSTRUMENT", "PHASES", "RESERVED", "ResolvedFault", "Sightings"]
