"""Elements of BehaviorTree.CPP → nodes as our tree files write them, each value with its place."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from executive.cli.importing.markup import Tag
from executive.cli.importing.scripts import expression
from executive.config.source import Mark, Place
from executive.config.validate import guess
from executive.core.errors import Problem
from executive.core.values import FLAG, INTEGER, NUMBER
from executive.report.show.groot import GUARDS
from executive.tree.expressions.typed import GuardError
from executive.tree.groot import Groot, Variant, as_given
from executive.tree.node_type import NodeType
from executive.tree.nodes.control import Children
from executive.tree.nodes.timeout import seconds

WORDS = {bt: ours for ours, bt in GUARDS.items()}
_EXPLICIT = frozenset({"Action", "Condition", "Control", "Decorator"})
_NOT_PORTS = frozenset({"ID", "name"})
_SCRIPTS_AFTER = frozenset({"_onSuccess", "_onFailure", "_onHalted", "_post"})
_NOTES = {
    "_while": "`while` fails its node when it no longer holds, where BehaviorTree.CPP skips it",
}
_NOT_OURS = {
    "SequenceWithMemory": "a sequence that goes on at the child that failed",
    "ParallelAll": "a parallel that waits for all children",
    "IfThenElse": "if-then-else; write it as a selector of sequences",
    "WhileDoElse": "while-do-else; write it with guards",
    "Switch2": "a switch; write it as a selector with guards",
    "ManualSelector": "a choice by hand",
    "RunOnce": "a child that runs once only",
    "LoopQueue": "a queue; `for_each` runs over a route",
    "Script": "a script; set values by ports of leaves",
    "SetBlackboard": "a value set by a node of its own; give it as a literal where it is read",
    "UnsetBlackboard": "a value unset",
}


@dataclass
class Draft:
    """A tree being put together: places of what was made, problems, notes, and unknown leaves.

    `remapped` holds, per sub-tree with _autoremap, its name and the ports given to it so far.
    """

    values: dict[Place, Mark] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    notes: list[Problem] = field(default_factory=list)
    unknown: set[str] = field(default_factory=set)
    remapped: list[tuple[str, dict[str, Any]]] = field(default_factory=list)


@dataclass
class Translator:
    """Translates the nodes of one tree. `types` are known nodes, `names` turns tree IDs into ours."""

    types: Mapping[str, NodeType]
    name_of: Callable[[str], str]
    draft: Draft

    def node(self, tag: Tag, place: Place) -> dict[str, Any]:
        """The node as a mapping; what is wrong with it is noted in the draft."""
        self.draft.values[place] = tag.mark
        meant = self._meant.get(tag.name)
        if meant is not None and meant[1].note:
            self.note(tag.mark, f"{tag.name} becomes {meant[1].note}")
        made = self._made(tag, place)
        kind = next(iter(made))
        name = tag.attributes.get("name", kind)
        if name != kind:
            self.draft.values[(*place, "name")] = tag.at("name")
            made["name"] = name
        return made | self._guards(tag, place)

    def note(self, mark: Mark, words: str) -> None:
        self.draft.notes.append(mark.problem(words))

    def problem(self, mark: Mark, words: str) -> None:
        self.draft.problems.append(mark.problem(words))

    def _made(self, tag: Tag, place: Place) -> dict[str, Any]:
        if tag.name == "SubTree":
            return self._subtree(tag, place)
        if tag.name in ("Sleep", "Delay"):
            return self._waiting(tag, place)
        if tag.name == "ScriptCondition":
            text = self._expression(tag, "code")
            return {"always": {}} | ({} if text is None else {"failure_if": f"not ({text})"})
        if tag.name in _NOT_OURS:
            words = f"got {tag.name}, {_NOT_OURS[tag.name]}; expected a node that our trees have"
            self.problem(tag.mark, words)
            return {"always": {}}
        meant, variant = self._meant.get(tag.name, (tag.name, Variant()))
        kind = tag.attributes.get("ID", tag.name) if tag.name in _EXPLICIT else meant
        return {kind: self._content(tag, kind, variant, (*place, kind))}

    @cached_property
    def _meant(self) -> Mapping[str, tuple[str, Variant]]:
        """By tag of BehaviorTree.CPP, our type and what the tag says of its ports."""
        variants = (
            (name, *pair) for name, kind in self.types.items() for pair in kind.groot.variants.items()
        )
        own = {kind.groot.tag: (name, Variant()) for name, kind in self.types.items()}
        return own | {tag: (name, variant) for name, tag, variant in variants}

    def _content(self, tag: Tag, kind: str, variant: Variant, place: Place) -> dict[str, Any]:
        self.draft.values[place] = tag.mark
        content = self._ports(tag, kind, place) | dict(variant.ports)
        known = self.types.get(kind)
        if known is None:
            self._unknown(tag, kind)
        if known is not None and known.children is Children.ONE:
            if len(tag.children) > 1:
                words = f"got {len(tag.children)} children of {tag.name}, expected exactly one"
                self.problem(tag.mark, words)
            inner = [self.node(child, (*place, "child")) for child in tag.children]
            return content | ({"child": inner[0]} if inner else {})
        children = [self.node(child, (*place, "children", n)) for n, child in enumerate(tag.children)]
        if known is not None and known.children is Children.NONE and children:
            self.problem(tag.children[0].mark, f"got a child of the leaf {kind}, expected none")
        return content | ({"children": children} if children else {})

    def _unknown(self, tag: Tag, kind: str) -> None:
        hint = guess(kind, self.types)
        if tag.children:
            self.problem(tag.mark, f'got the unknown control or decorator "{kind}"{hint}')
        elif kind not in self.draft.unknown:
            self.note(tag.mark, f'the leaf "{kind}" is not known here: kept by name, to be written{hint}')
        self.draft.unknown.add(kind)

    def _ports(self, tag: Tag, kind: str, place: Place) -> dict[str, Any]:
        given = {k: v for k, v in tag.attributes.items() if k not in _NOT_PORTS and not k.startswith("_")}
        groot = self.types[kind].groot if kind in self.types else Groot(kind)
        ours = {attribute.name: (port, attribute.read) for port, attribute in groot.attributes.items()}
        content: dict[str, Any] = {}
        for bt, text in given.items():
            if bt in groot.constants:
                self._constant(tag.at(bt), bt, text, *groot.constants[bt])
                continue
            port, read = ours.get(bt, (bt, as_given))
            self.draft.values[(*place, port)] = tag.at(bt)
            try:
                value = read(text, len(tag.children))
            except ValueError as error:
                self.problem(tag.at(bt), str(error))
                continue
            if value is not None:
                content[port] = self._value(tag.at(bt), kind, port, value)
        return content

    def _constant(self, mark: Mark, bt: str, text: str, only: str, why: str) -> None:
        if text != only:
            self.problem(mark, f'got {bt} "{text}", expected {only}: {why}')

    def _value(self, mark: Mark, kind: str, port: str, text: object) -> object:
        """What the attribute says, as YAML would have it for a port of that type."""
        if not isinstance(text, str):
            return text
        if text == "{=}":
            return f"{{{port}}}"
        if text.startswith("{@"):
            self.problem(mark, f'got "{text}" of the global blackboard, expected a value passed to the tree')
        known = self.types.get(kind)
        declared = next((p for p in known.ports if p.name == port), None) if known else None
        return plain(text, declared.type.name) if declared else text

    def _subtree(self, tag: Tag, place: Place) -> dict[str, Any]:
        if "ID" not in tag.attributes:
            self.problem(tag.mark, "got a SubTree without ID, expected the name of a tree")
        kind = self.name_of(tag.attributes.get("ID", "missing"))
        self.draft.values[(*place, kind)] = tag.at("ID")
        content = self._ports(tag, kind, (*place, kind))
        if tag.attributes.get("_autoremap", "").lower() in ("true", "1"):
            self.draft.remapped.append((kind, content))
        return {kind: content}

    def _waiting(self, tag: Tag, place: Place) -> dict[str, Any]:
        key = "msec" if tag.name == "Sleep" else "delay_msec"
        wait = {"wait": {"duration": seconds(tag.attributes.get(key, "missing"))}}
        if tag.name == "Sleep":
            self.draft.values[(*place, "wait", "duration")] = tag.at(key)
            return wait
        listing: Place = (*place, "sequence", "children")
        self.draft.values[(*listing, 0, "wait", "duration")] = tag.at(key)
        inner = [self.node(child, (*listing, n)) for n, child in enumerate(tag.children, start=1)]
        return {"sequence": {"children": [wait, *inner]}}

    def _guards(self, tag: Tag, place: Place) -> dict[str, str]:
        made: dict[str, str] = {}
        for attribute in tag.attributes:
            if attribute in _SCRIPTS_AFTER:
                words = f"got {attribute}, a script run afterwards; expected none: set values by ports"
                self.problem(tag.at(attribute), words)
            elif attribute in WORDS and (text := self._expression(tag, attribute)) is not None:
                self.draft.values[(*place, WORDS[attribute])] = tag.at(attribute)
                made[WORDS[attribute]] = text
                if attribute in _NOTES:
                    self.note(tag.at(attribute), _NOTES[attribute])
        return made

    def _expression(self, tag: Tag, attribute: str) -> str | None:
        try:
            return expression(tag.attributes.get(attribute, ""))
        except GuardError as error:
            self.problem(tag.at(attribute), error.message)
            return None


def plain(text: str, kind: str) -> object:
    """Text of an attribute as a whole number, number or flag where the port is of that type."""
    if kind == FLAG.name and text.lower() in ("true", "false", "1", "0"):
        return text.lower() in ("true", "1")
    if kind in (INTEGER.name, NUMBER.name) and re.fullmatch(r"[-+]?\d+", text):
        return int(text)
    if kind == NUMBER.name and re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", text):
        return float(text)
    return text
