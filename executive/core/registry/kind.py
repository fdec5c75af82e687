"""What can be added: a kind says by which name, of which type, and what an entry must keep."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

T = TypeVar("T")


def own_name(entry: object) -> str | None:
    """The `name` that an entry bears itself; None where it has none."""
    name = vars(entry).get("name") if isinstance(entry, type) else getattr(entry, "name", None)
    return name if isinstance(name, str) else None


def nothing_broken(entry: Any) -> Iterable[str]:
    """The `check` of a kind whose type says all."""
    return ()


def nothing_former(entry: Any) -> tuple[str, ...]:
    """The `former_names_of` a kind whose names never changed."""
    return ()


@dataclass(frozen=True)
class Kind(Generic[T]):
    """A kind of thing that can be added, declared where its type lives.

    An entry is an instance of `type`, or with `classes` a subclass of it. `plural` is the command that lists
    them and the end of their entry point group, `longarm.<plural>`. `check` is the cheap part of the public
    checker: a sentence for each promise that an entry breaks; it runs when the entry is first used.
    `name_of` is the name an entry gives itself, which must be the one it is registered by (None: none).
    `former_names_of` gives others that it may still be registered by. `page` is what the catalogue says of an
    entry (None: its fields). What is not `scanned` for in modules needs an entry point.
    """

    name: str
    plural: str
    doc: str
    type: type[Any]
    classes: bool = False
    check: Callable[[T], Iterable[str]] = nothing_broken
    name_of: Callable[[T], str | None] = own_name
    former_names_of: Callable[[T], tuple[str, ...]] = nothing_former
    page: Callable[[T], Mapping[str, Any]] | None = None
    scanned: bool = True

    @property
    def group(self) -> str:
        """The entry point group."""
        return group_of(self.plural)

    def fits(self, entry: object) -> bool:
        """Whether something is of this kind's type."""
        if self.classes:
            return isinstance(entry, type) and issubclass(entry, self.type) and entry is not self.type
        return isinstance(entry, self.type)

    def faults_of(self, name: str, entry: Any) -> tuple[str, ...]:
        """All that is wrong with an entry registered by this name."""
        if not self.fits(entry):
            wanted = f"a subclass of {self.type.__name__}" if self.classes else _one(self.type)
            return (f"got {_shown(entry)}, expected {wanted}",)
        own = self.name_of(entry)
        other = (
            ()
            if own in (None, name) or name in self.former_names_of(entry)
            else (f"its own name is {own!r}",)
        )
        return (*other, *self.check(entry))


def group_of(plural: str) -> str:
    """The entry point group of a kind."""
    return f"longarm.{plural}"


def _shown(entry: object) -> str:
    return f"the class {entry.__name__}" if isinstance(entry, type) else _one(type(entry))


def _one(of: type[Any]) -> str:
    return f"{'an' if of.__name__[0].lower() in 'aeiou' else 'a'} {of.__name__}"
