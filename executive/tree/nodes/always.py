"""A leaf that ends as it is told: for sketches and tests of trees."""

from __future__ import annotations

from executive.core.types import Outcome, Reason
from executive.core.values import FLAG, TEXT
from executive.tree.groot import Groot, Variant
from executive.tree.nodes.base import In, Leaf


class Always(Leaf):
    """End at once, well or not, as told."""

    outcomes = (Reason.DONE, Reason.UNEXPECTED)
    groot = Groot(
        "always",
        variants={"AlwaysSuccess": Variant({"success": True}), "AlwaysFailure": Variant({"success": False})},
    )

    success = In(FLAG, "whether to succeed", default=True)
    detail = In(TEXT, "what to give as the detail", default="")

    def step(self) -> Outcome[object]:
        return Outcome(Reason.DONE if self.success else Reason.UNEXPECTED, self.detail)
