"""What became of the mutants, as text for people and as data."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from proving.mutation.mutate import Score
from proving.mutation.trial import Found


def as_text(score: Score) -> str:
    """Survivors with their diffs, then the score by operator and by tree, and who notices most."""
    return "\n".join([*_survivors(score), *_summary(score), ""])


def as_data(score: Score) -> dict[str, Any]:
    """Everything, for `--json`."""
    return {
        "score": score.ratio,
        "killed": score.killed,
        "survived": len(score.survivors),
        "equivalent": len(score.equivalent),
        "wall_s": round(score.wall_s, 3),
        "mutants_per_hour": round(score.per_hour, 1),
        "baselines": [
            {"file": str(b.file), "verdict": str(b.account.verdict.word), "missed": b.account.missed}
            for b in score.baselines
        ],
        "mutants": [_mutant(found, score) for found in score.found],
    }


def _mutant(found: Found, score: Score) -> dict[str, Any]:
    mutant = found.mutant
    return {
        "name": mutant.name,
        "tree": mutant.file.stem,
        "node": mutant.node,
        "operator": mutant.operator,
        "killed_by": None if found.killer is None else str(found.killer),
        "why": found.why,
        "runs": found.runs,
        "changed": found.changed,
        "equivalent": score.equivalent.get(mutant),
        "diff": mutant.diff(),
    }


def _by(title: str, score: Score, key: Callable[[Found], str]) -> Iterator[str]:
    for name in dict.fromkeys(map(key, score.found)):
        mine = [f for f in score.found if key(f) == name and f.mutant not in score.equivalent]
        killed = sum(f.killer is not None for f in mine)
        yield f"  {title:8} {name:28} {killed:4} of {len(mine)}"


def _survivors(score: Score) -> Iterator[str]:
    for found in score.survivors:
        yield f"survived: {found.mutant.name} ({_how(found)})"
        yield found.mutant.diff() + "\n"


def _how(found: Found) -> str:
    if not found.runs:
        return found.why
    went = "it ran otherwise, within what is expected" if found.changed else "nothing went otherwise"
    reach = "1 scenario reaches it" if found.runs == 1 else f"{found.runs} scenarios reach it"
    return f"{reach}; {went}"


def _summary(score: Score) -> Iterator[str]:
    alive, spared = len(score.survivors), len(score.equivalent)
    yield (
        f"{score.ratio:.1%} of the mutants were noticed ({score.killed} of {score.killed + alive}"
        + (f", {spared} equivalent by their reasons" if spared else "")
        + f"), {score.per_hour:.0f} mutants an hour"
    )
    yield from _by("operator", score, lambda found: found.mutant.operator)
    yield from _by("tree", score, lambda found: found.mutant.file.stem)
    for baseline in score.baselines:
        kills = sum(f.killer == baseline.file for f in score.found)
        note = "" if baseline.passed else f"  ({baseline.account.verdict.word} as it is)"
        yield f"  {baseline.file} noticed {kills}{note}"
