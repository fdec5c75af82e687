"""What every type of node declares on its class, leaf or control node: name, doc, ports, devices, drawing."""

from __future__ import annotations

import re
from typing import Any, ClassVar

from executive.tree.groot import Groot
from executive.tree.ports import PortSpec, declared_ports


class Declared:
    """Base of node classes. `name` is what tree files call the type: by default the class's in snake_case.

    Files may still use one of its `former_names`. `symbol` stands before the name in drawings. `needs` names
    the devices without which no tree with this node can run. `groot` is what BehaviorTree.CPP calls it, where
    it has such a node.
    """

    name: ClassVar[str] = ""
    former_names: ClassVar[tuple[str, ...]] = ()
    symbol: ClassVar[str] = ""
    needs: ClassVar[tuple[str, ...]] = ()
    groot: ClassVar[Groot | None] = None

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        if "name" not in vars(cls):
            cls.name = snake_case(cls.__name__)

    @classmethod
    def ports(cls) -> tuple[PortSpec, ...]:
        """The declared ports, in order of declaration, base classes first."""
        return declared_ports(cls)

    @classmethod
    def doc(cls) -> str:
        """The first paragraph of the docstring, on one line."""
        return " ".join((cls.__doc__ or "").strip().split("\n\n")[0].split())


def snake_case(name: str) -> str:
    """`ForEach` → `for_each`."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()
