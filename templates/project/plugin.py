"""A leaf and a strategy of your own. `longarm nodes` and `longarm strategies` list them."""

import math
from pathlib import Path

from longarm import ANGLE, In, Leaf, Outcome, Reason, Strategy


class StandsLevel(Leaf):
    """Does the rover stand level enough to go on?"""

    # Trees call it stands_level. Ports are declared once; `check` and editors know them.
    condition = True  # it answers at once; a leaf that takes time returns None until it has ended
    outcomes = (Reason.DONE, Reason.TILT)
    tilt = In[float](ANGLE, "how far the body leans")  # radians inside, `20 deg` in files
    at_most = In[float](ANGLE, "the largest tilt allowed", default=math.radians(20.0))

    def step(self) -> Outcome[object]:
        reason = Reason.DONE if self.tilt <= self.at_most else Reason.TILT
        return Outcome(reason, f"{math.degrees(self.tilt):.1f} deg")


LOOK_AGAIN = Strategy(
    name="look_again",
    doc="Wait five minutes for what hides the markers to pass, and measure again.",
    tree=Path(__file__).parent / "trees" / "look_again.yaml",
    answers={"illumination_change": 1.0, "marker_lost": 0.5, "lost_rover": 0.4},  # see `longarm hypotheses`
    reasons={Reason.NOT_SEEN: 0.5, Reason.UNSTABLE_IMAGES: 0.5},  # how the leaf failed
    cost_s=330.0,  # mission time; cheaper than the shipped wait_for_sight, so it is tried before that
)
