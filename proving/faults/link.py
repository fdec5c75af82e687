"""Faults of the link to ground. What they take effect on is a call: without one they prove nothing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

from pydantic import Field

from executive.core.devices import LINK
from executive.core.ports import Action, Devices, Link
from executive.core.types import Call, Outcome, Reason
from executive.core.units import Duration, Fraction
from executive.run import Cue, FaultSpec
from proving.faults.altered import Altered, Counted, Held, Unanswered
from proving.faults.parameters import Nothing, Parameters

NO_ANSWER: Outcome[str] = Outcome(Reason.TIMEOUT, "no answer from ground")


class LinkFault(Counted):
    """What becomes of calls. Subclasses write `call`, which is asked for every call, active or not."""

    def wrap(self, devices: Devices, cue: Cue) -> Devices:
        return devices.replace(LINK, _FaultyLink(devices[LINK], cue, self))

    def call(self, link: Link, call: Call, cue: Cue) -> Action[str]:
        raise TypeError(f"{type(self).__name__} does nothing to a call")


@dataclass
class _FaultyLink:
    inner: Link
    cue: Cue
    fault: LinkFault

    def call(self, call: Call) -> Action[str]:
        return self.fault.call(self.inner, call, self.cue)


class LinkDelayed(Parameters):
    """How late."""

    by: Annotated[Duration, Field(gt=0, le=864_000, description="how long the answer is held back")] = 3600.0


class LinkDelay(LinkFault):
    """The answer to a call made while the fault is there comes late."""

    def __init__(self, parameters: LinkDelayed) -> None:
        self._by_s = parameters.by

    def call(self, link: Link, call: Call, cue: Cue) -> Action[str]:
        under_way = link.call(call)
        return Held(under_way, cue.clock, self._by_s, self) if cue.active else under_way


class Patience(Parameters):
    """How long a call waits for its answer."""

    patience: Annotated[
        Duration, Field(gt=0, le=864_000, description="after this a call that got no answer times out")
    ] = 3600.0


class Dropping(Patience):
    """How many calls are lost, and how long one waits for its answer."""

    chance: Annotated[Fraction, Field(gt=0, le=1, description="of each call to be lost")] = 1.0


class LinkDrop(LinkFault):
    """A call is lost on its way: it never reaches ground, and times out."""

    def __init__(self, parameters: Dropping) -> None:
        self._chance, self._patience_s = parameters.chance, parameters.patience

    def call(self, link: Link, call: Call, cue: Cue) -> Action[str]:
        if not cue.active or cue.rng.uniform() >= self._chance:
            return link.call(call)
        self.altered += 1
        return Unanswered(cue.clock, self._patience_s, NO_ANSWER)


class LinkOutage(LinkFault):
    """Nothing gets through either way: calls made meanwhile are lost, and answers due meanwhile too."""

    def __init__(self, parameters: Patience) -> None:
        self._patience_s = parameters.patience

    def call(self, link: Link, call: Call, cue: Cue) -> Action[str]:
        if cue.active:
            self.altered += 1
            return Unanswered(cue.clock, self._patience_s, NO_ANSWER)
        return Altered(link.call(call), lambda outcome: self._arriving(outcome, cue))

    def _arriving(self, outcome: Outcome[str], cue: Cue) -> Outcome[str]:
        if not (outcome.ok and cue.active):
            return outcome
        self.altered += 1
        return NO_ANSWER


class LinkDuplicate(LinkFault):
    """Ground hears a call twice; what it answers to the second is heard by nobody."""

    def __init__(self, parameters: Nothing) -> None: ...

    def call(self, link: Link, call: Call, cue: Cue) -> Action[str]:
        first = link.call(call)
        if cue.active:
            link.call(call)
            self.altered += 1
        return first


class Corruption(Parameters):
    """How much of an answer is garbled."""

    share: Annotated[Fraction, Field(gt=0, le=1, description="characters garbled, on average")] = 0.3


class LinkCorrupt(LinkFault):
    """The answer arrives garbled."""

    def __init__(self, parameters: Corruption) -> None:
        self._share = parameters.share

    def call(self, link: Link, call: Call, cue: Cue) -> Action[str]:
        return Altered(link.call(call), lambda outcome: self._arriving(outcome, cue))

    def _arriving(self, outcome: Outcome[str], cue: Cue) -> Outcome[str]:
        if outcome.value is None or not cue.active:
            return outcome
        hit = cue.rng.uniform(size=len(outcome.value)) < self._share
        garbage = cue.rng.integers(0x21, 0x7F, len(outcome.value))
        characters = zip(outcome.value, hit, garbage, strict=True)
        garbled = "".join(chr(g) if h else c for c, h, g in characters)
        self.altered += garbled != outcome.value
        return replace(outcome, value=garbled)


class Replay(Parameters):
    """What an earlier pass left behind."""

    answer: Annotated[str, Field(min_length=1, max_length=1000, description="ground's answer of old")] = (
        "received: blocked; go on"
    )


class ReplayedUplink(LinkFault):
    """A call is answered at once, by what ground sent in an earlier pass; it never gets to ground."""

    def __init__(self, parameters: Replay) -> None:
        self._answer = parameters.answer

    def call(self, link: Link, call: Call, cue: Cue) -> Action[str]:
        if not cue.active:
            return link.call(call)
        self.altered += 1
        return Unanswered(cue.clock, 0.0, Outcome(Reason.DONE, "answer from ground", self._answer))


LINK_DELAY = FaultSpec(
    "link_delay", "Ground's answer to a call comes late.", LinkDelayed, LinkDelay, "", category="link"
)
LINK_DROP = FaultSpec(
    "link_drop",
    "A call is lost on its way, and times out.",
    Dropping,
    LinkDrop,
    "",
    category="link",
)
LINK_OUTAGE = FaultSpec(
    "link_outage",
    "Nothing gets through: calls made meanwhile are lost, and answers that are due.",
    Patience,
    LinkOutage,
    "",
    category="link",
)
LINK_DUPLICATE = FaultSpec(
    "link_duplicate", "Ground hears each call twice.", Nothing, LinkDuplicate, "", category="link"
)
LINK_CORRUPT = FaultSpec(
    "link_corrupt", "Ground's answer arrives garbled.", Corruption, LinkCorrupt, "", category="link"
)
REPLAYED_UPLINK = FaultSpec(
    "replayed_uplink",
    "A call is answered at once by what ground sent in an earlier pass.",
    Replay,
    ReplayedUplink,
    "",
    category="link",
)
