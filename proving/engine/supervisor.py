"""Runs cases in N slots, one child each; retries once what the machine has spoilt."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Generator, Iterable

from proving.engine.case import Case, CaseClass, Ending
from proving.engine.post_mortem import ending_of
from proving.engine.server import ForkServer

ATTEMPTS = 2
"""How often a case is begun at most, if each time the machine spoils it."""


def run_cases(
    cases: Iterable[Case], slots: int, begun: Callable[[Case], None] = lambda case: None
) -> Generator[Ending, None, None]:
    """The ending of each case, in the order in which they end.

    A case is taken from `cases` when a slot is free, so that who gives them may stop giving. Closing the
    iterator (or an exception in it, Ctrl-C too) kills what is under way.
    """
    slots = max(1, slots)
    waiting, server = iter(cases), ForkServer()
    attempts: Counter[str] = Counter()

    def begin(case: Case) -> None:
        attempts[case.key] += 1
        if attempts[case.key] == 1:
            begun(case)
        case.clear()
        server.begin(case)

    try:
        while True:
            while server.alive < slots and (case := next(waiting, None)) is not None:
                begin(case)
            if not server.alive:
                return
            for case, death in server.deaths():
                ending = ending_of(case, death, attempts[case.key])
                if server.gone:
                    server.close()
                    server = ForkServer()
                if ending.kind is CaseClass.INFRASTRUCTURE and attempts[case.key] < ATTEMPTS:
                    begin(case)
                else:
                    yield ending
    finally:
        server.close()


def run_alone(server: ForkServer, case: Case) -> Ending:
    """One case to its end, begun anew once if the machine spoilt it."""
    for attempt in range(1, ATTEMPTS + 1):
        case.clear()
        server.begin(case)
        while not (deaths := server.deaths()):
            pass
        ending = ending_of(case, deaths[0][1], attempt)
        if ending.kind is not CaseClass.INFRASTRUCTURE:
            break
    return ending
