"""Who reads and who writes which value of a tree, and whether that fits: types, attributes, never-written."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from executive.config.source import Mark
from executive.config.validate import guess, listed
from executive.core.errors import Problem
from executive.core.values import NUMBER, ValueType, attribute_of
from executive.tree.expressions.guards import Guard
from executive.tree.expressions.typed import GuardError
from executive.tree.ports import Direction, PortSpec
from executive.tree.spec import Reference


@dataclass(frozen=True)
class Use:
    """A reference given for a port of some node."""

    reference: Reference
    port: PortSpec
    mark: Mark


class Flow:
    """Collects the values of one tree, then says what does not fit."""

    def __init__(self, ports: tuple[PortSpec, ...]) -> None:
        self.types: dict[str, ValueType[Any]] = {port.name: port.type for port in ports}
        self.read_only = {port.name for port in ports if port.direction is Direction.IN}
        self.uses: list[Use] = []
        self.guards: list[tuple[Guard, Mark]] = []

    def use(self, reference: Reference, port: PortSpec, mark: Mark) -> None:
        """A node's port is given this reference; one that is written makes its value exist."""
        self.uses.append(Use(reference, port, mark))
        if port.direction is not Direction.IN:
            self.types.setdefault(reference.name, port.type)

    def item(self, name: str, kind: ValueType[Any], mark: Mark) -> Iterator[Problem]:
        """A for_each writes this value."""
        known = self.types.setdefault(name, kind)
        if known.name != kind.name:
            yield mark.problem(f"got {{{name}}} for a {kind.name}, but it is a {known.name} in this tree")

    def guard(self, guard: Guard, mark: Mark) -> None:
        self.guards.append((guard, mark))

    def problems(self) -> Iterator[Problem]:
        """Everything that does not fit, once all nodes have been seen."""
        for use in self.uses:
            yield from self._use_problems(use)
        for guard, mark in self.guards:
            try:
                guard.check(self.types)
            except GuardError as error:
                yield mark.problem(error.message, error.offset)

    def _use_problems(self, use: Use) -> Iterator[Problem]:
        name = use.reference.name
        if name not in self.types:
            known = sorted(self.types)
            expected = listed([f"{{{k}}}" for k in known]) or "one that is"
            message = (
                f"got {{{name}}}, which is neither a port of this tree nor written in it, expected {expected}"
            )
            yield use.mark.problem(message + guess(name, known))
            return
        if use.port.direction is not Direction.IN and name in self.read_only:
            yield use.mark.problem(
                f"got {{{name}}} for a port that is written, but it is an in port of this tree"
            )
        try:
            found = attribute_of(self.types[name], use.reference.attributes)
        except LookupError as error:
            wrong, owner, known_names = error.args
            expected = listed(known_names) or "none"
            message = f'got the unknown attribute "{wrong}" of a {owner}, expected {expected}'
            yield use.mark.problem(message + guess(wrong, known_names))
            return
        if not fits(found, use.port):
            message = f"got {use.reference}, of type {found.name}, expected type {use.port.type.name}"
            yield use.mark.problem(message)


def fits(found: ValueType[Any], port: PortSpec) -> bool:
    """Whether a value of this type can stand for the port: the same type, or an integer read as a number."""
    if port.direction is Direction.IN and port.type.name == NUMBER.name and found.name == "integer":
        return True
    return found.name == port.type.name
