"""Stop safely and call home."""

from __future__ import annotations

from executive.core.devices import DRIVE, LINK
from executive.core.ports import Action
from executive.core.types import Call, Outcome, Reason
from executive.core.values import DURATION
from executive.tree.nodes.action import ActionLeaf
from executive.tree.nodes.base import In


class CallForHelp(ActionLeaf):
    """Stop the rover, send the evidence to ground, and end: what comes next is ground's decision.

    Always fails, with the reason that led here: the mission did not reach its goal by itself. An answer that
    does not come changes nothing in that, so it is not waited for beyond `patience`.
    """

    patience = In[float](DURATION, "how long to wait for ground's answer", default=6 * 3600.0)

    needs = ("drive", "link")
    outcomes = (Reason.NO_STRATEGY,)
    interruptible = False  # whatever happens, ground is told
    late = Reason.TIMEOUT

    def request(self) -> Action[str]:
        self.services.devices[DRIVE].stop()
        failed = self.trace.last_failure
        path, outcome = failed if failed else ("", Outcome[object](Reason.NO_STRATEGY))
        weights = self.services.classification.weights
        evidence = {name: round(w, 4) for name, w in weights.items() if w >= 0.01}
        call = Call(self.services.clock.now_s, outcome.reason, f"{path}: {outcome.detail}", evidence)
        self.services.journal.call(call)
        self._why = outcome
        return self.services.devices[LINK].call(call)

    def finish(self, outcome: Outcome[str]) -> Outcome[object]:
        unanswered = "" if outcome.ok else f" ({outcome.detail})"
        return Outcome(Reason.NO_STRATEGY, f"{self._why.reason}: {self._why.detail}{unanswered}")
