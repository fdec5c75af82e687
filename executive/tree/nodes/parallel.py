"""All children at once."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

from py_trees import common, composites
from py_trees.behaviour import Behaviour

from executive.core.values import TEXT
from executive.tree.abilities import FAILS, RUNS, SUCCEEDS, Abilities, all_of, any_of, only
from executive.tree.groot import Attribute, Groot
from executive.tree.nodes.control import ControlNode, NodeContext
from executive.tree.order import Child, Ends, Known, both
from executive.tree.ports import In


def _success_count(policy: object) -> str:
    return "-1" if policy == "all" else "1"


def _policy(success_count: str, children: int) -> object:
    if success_count in ("-1", str(children)):
        return None
    if success_count != "1":
        raise ValueError(f'got success_count "{success_count}", expected 1 or all children')
    return "one"


class Parallel(ControlNode):
    """Run the children at once; fail as soon as one fails."""

    symbol = "⇉"
    groot = Groot(
        "Parallel",
        {"policy": Attribute("success_count", _success_count, _policy)},
        constants={"failure_count": ("1", "ours fails as soon as one child does")},
    )

    policy = In[str](
        TEXT, "succeed when all or one of the children did", "all", choices=("all", "one"), fixed=True
    )

    def make(self, children: Sequence[Behaviour], context: NodeContext) -> Behaviour:
        policies = {"all": common.ParallelPolicy.SuccessOnAll, "one": common.ParallelPolicy.SuccessOnOne}
        return composites.Parallel(context.name, policies[self.policy](), list(children))

    def abilities(self, inside: Sequence[Abilities]) -> Abilities:
        able = any_of(inside)
        succeeds = able if self.policy == "one" else all_of(inside)
        return only(able, RUNS, FAILS) | only(succeeds, SUCCEEDS)

    def certain(self, before: Known, children: Sequence[Child]) -> Ends:
        ends = [child(before) for child in children]
        succeeded = [each.succeeded for each in ends]
        if self.policy == "one":
            return Ends(reduce(both, succeeded), before)
        done = None if None in succeeded else frozenset[str]().union(*(known for known in succeeded if known))
        return Ends(done, before)

    def interrupts(self, index: int, count: int) -> bool:
        return count > 1
