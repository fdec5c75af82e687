"""Would the tests notice if what keeps the rover safe were a little different? Mutants of the modules below.

    python -m benchmarks.safety_mutants OUT                     # resumes what OUT/mutants.jsonl has not
    python -m benchmarks.safety_mutants OUT --module executive/isc/gate.py
    python -m benchmarks.safety_mutants OUT --sample 100 --seed 1

Each mutant halves or doubles a constant, swaps a comparison for a neighbour, a sign for the other, `and` for
`or`, or drops a `not`; messages (f-strings) are left alone. It is judged by the unit tests of its module's
folder alone, `tests/<same folder>`, nearest first, in a forked process that loads the mutated source instead.
A test that fails, and one that does not end in time, kills it. A result is kept under the digest of the
module and of the tests it met: whatever changes is judged again.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import importlib
import importlib.abc
import importlib.machinery
import importlib.util
import json
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, ModuleType

import numpy as np
import yaml

ROOT = Path(__file__).parents[1]
ARGUED = Path(__file__).with_suffix(".yaml")
MOST_S = 60  # of one mutant; the slowest folder's tests take a third of that
HEAVY = (
    "numpy.random",
    "scipy.optimize",
    "scipy.stats",
    "cv2",
    "pydantic",
    "pint",
    "py_trees",
    "pytest",
    "hypothesis",
)

MODULES = {
    "executive/isc/gate.py": "how far a fix may lie from the last: a wrong fix leads off the corridor",
    "executive/navigation/belt_watch.py": "which belts are said to stand still or to run wild under way",
    "executive/navigation/belt_rest.py": "belts that move though nothing is commanded",
    "executive/isc/correction.py": "the bounds of the learnt advance, and the certainty left after a fix",
    "executive/isc/motion.py": "how fast certainty is lost on the way: margins are counted in its sigmas",
    "executive/core/corridor.py": "the corridor and the room left in it",
    "executive/core/arrival.py": "whether a way-point counts as reached",
    "executive/navigation/guidance.py": "how far and where to the belts are told to drive",
    "executive/isc/prediction.py": "where the rover is thought to be between fixes",
    "executive/isc/evidence_check.py": "which fixes are too good to be true",
    "executive/isc/tracker.py": "what passes the gate, and what blind driving is counted",
    "executive/isc/attitude.py": "the tilt that the inclinometers tell, and angles wrapped",
    "executive/isc/doubt.py": "how much less is believed after a move that went wrong",
    "executive/tree/nodes/driving.py": "what ends a drive under way: tilt, tether, belts, margin",
    "executive/tree/nodes/drive_leg.py": "how long a leg may be",
    "executive/tree/nodes/drive_straight.py": "how far is driven blind",
    "executive/tree/nodes/turn_towards.py": "how far is turned at once",
    "executive/tree/nodes/conditions.py": "the questions that guard driving: arrived, inside the margin",
    "executive/run/runner.py": "how a run ends, and that the rover stands when it does",
}

SWAPPED: dict[type[ast.AST], tuple[str, ...]] = {
    ast.Lt: ("<=", ">"),
    ast.LtE: ("<", ">="),
    ast.Gt: (">=", "<"),
    ast.GtE: (">", "<="),
    ast.Eq: ("!=",),
    ast.NotEq: ("==",),
    ast.Is: ("is not",),
    ast.IsNot: ("is",),
    ast.In: ("not in",),
    ast.NotIn: ("in",),
    ast.Add: ("-",),
    ast.Sub: ("+",),
}


@dataclass(frozen=True)
class Mutant:
    """One change of a module's text: `after` in place of its characters `start` to `end`."""

    module: str
    line: int
    start: int
    end: int
    before: str
    after: str

    @property
    def name(self) -> str:
        return f"{self.module}:{self.line}: {self.before} -> {self.after} @{self.start}"


def mutants(module: str, text: str) -> list[Mutant]:
    """All mutants of a module, in the order of its text."""
    data = text.encode()
    starts = [0]
    for line in data.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    found = []
    for node in _of_code(ast.parse(text)):
        start = starts[node.lineno - 1] + node.col_offset
        end = starts[(node.end_lineno or node.lineno) - 1] + (node.end_col_offset or 0)
        before = data[start:end].decode()
        found += [Mutant(module, node.lineno, start, end, before, after) for after in _changed(node, before)]
    return sorted(found, key=lambda mutant: (mutant.start, mutant.end, mutant.after))


def _of_code(tree: ast.AST) -> Iterator[ast.expr | ast.stmt]:
    """Expressions and statements, but for messages."""
    for child in ast.iter_child_nodes(tree):
        if isinstance(child, ast.JoinedStr):
            continue
        if isinstance(child, ast.expr | ast.stmt):
            yield child
        yield from _of_code(child)


def _changed(node: ast.expr | ast.stmt, before: str) -> Iterator[str]:
    match node:
        case ast.Constant(value=bool()):
            return
        case ast.Constant(value=int() as number):
            yield from (repr(other) for other in (number // 2, number * 2) if other != number)
        case ast.Constant(value=float() as number):
            yield from (repr(other) for other in (number / 2, number * 2) if other != number)
        case ast.Compare(left=left, ops=ops, comparators=others):
            operands = [left, *others]
            for index, op in enumerate(ops):
                for swapped in SWAPPED[type(op)]:
                    signs = [swapped if i == index else SIGNS[type(o)] for i, o in enumerate(ops)]
                    pairs = zip(signs, operands[1:], strict=True)
                    tail = " ".join(f"{sign} ({ast.unparse(operand)})" for sign, operand in pairs)
                    yield f"(({ast.unparse(left)}) {tail})"
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as op, right=right):
            yield f"(({ast.unparse(left)}) {SWAPPED[type(op)][0]} ({ast.unparse(right)}))"
        case ast.AugAssign(target=target, op=ast.Add() | ast.Sub() as op, value=value):
            yield f"{ast.unparse(target)} {SWAPPED[type(op)][0]}= {ast.unparse(value)}"
        case ast.UnaryOp(op=ast.USub() | ast.Not(), operand=operand):
            yield f"({ast.unparse(operand)})"
        case ast.BoolOp(op=op, values=values):
            other = " or " if isinstance(op, ast.And) else " and "
            yield "(" + other.join(f"({ast.unparse(value)})" for value in values) + ")"


SIGNS: dict[type[ast.AST], str] = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
    ast.Is: "is", ast.IsNot: "is not", ast.In: "in", ast.NotIn: "not in",
}  # fmt: skip


class Mutated(importlib.abc.MetaPathFinder):
    """Gives one module from a changed text, all others as ever."""

    def __init__(self, module: str, text: str) -> None:
        self.module, self.text = module, text

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        if name.replace(".", "/") + ".py" != self.module:
            return None
        text, file = self.text, str(ROOT / self.module)

        class Loader(importlib.machinery.SourceFileLoader):
            def get_code(self, fullname: str) -> CodeType:
                return compile(text, file, "exec")

        return importlib.util.spec_from_file_location(name, file, loader=Loader(name, file))


def tests_of(module: str) -> list[Path]:
    """The tests of a module's folder: first those named like it, then those that import it, then the rest."""
    stem, dotted = Path(module).stem, module.removesuffix(".py").replace("/", ".")
    folder = ROOT / "tests" / Path(module).parent

    def distance(test: Path) -> tuple[int, int]:
        text = test.read_text()
        return 0 if stem in test.stem else 1 if dotted in text or f"import {stem}" in text else 2, len(text)

    return sorted(folder.glob("test_*.py"), key=distance)


def fate(module: str, text: str, tests: Sequence[Path]) -> str:
    """`passed`, `killed` or `timed out`: what the tests say of a module with this text."""
    child = os.fork()
    if child == 0:
        os.setsid()
        signal.alarm(MOST_S)  # its default action ends the process, whatever loops in it
        silence = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silence, 1)
        os.dup2(silence, 2)
        sys.meta_path.insert(0, Mutated(module, text))
        import pytest

        code = 2
        try:
            # no database of hypothesis' examples, no cache: a mutant must not hear of the one before
            code = pytest.main(["-x", "-q", "--assert=plain", "-p", "no:cacheprovider", *map(str, tests)])
        finally:
            os._exit(int(code))
    status = os.waitpid(child, 0)[1]
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGALRM:
        return "timed out"
    return "passed" if os.waitstatus_to_exitcode(status) == 0 else "killed"


def judged(module: str, chosen: Sequence[Mutant], kept: Path) -> dict[str, str]:
    """The fate of each mutant, from the file or judged now and added to it.

    Raises SystemExit where the tests fail without any change: they would kill everything.
    """
    text, tests = (ROOT / module).read_text(), tests_of(module)
    if not tests:
        return {mutant.name: "passed" for mutant in chosen}
    material = text + "".join(test.read_text() for test in tests)
    stamp = hashlib.sha256(material.encode()).hexdigest()[:16]
    rows = [json.loads(line) for line in kept.read_text().splitlines()] if kept.exists() else []
    fates = {row["mutant"]: row["fate"] for row in rows if row["stamp"] == stamp}
    left = [mutant for mutant in chosen if mutant.name not in fates]
    if left and fate(module, text, tests) != "passed":
        raise SystemExit(f"{module}: its tests fail without any change")
    for mutant in left:
        data = text.encode()
        changed = (data[: mutant.start] + mutant.after.encode() + data[mutant.end :]).decode()
        fates[mutant.name] = fate(module, changed, tests)
        with kept.open("a") as file:
            file.write(json.dumps({"stamp": stamp, "mutant": mutant.name, "fate": fates[mutant.name]}) + "\n")
    return {mutant.name: fates[mutant.name] for mutant in chosen}


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("out", type=Path, help="folder of mutants.jsonl")
    arguments.add_argument(
        "--module", action="append", choices=MODULES, help="this module only; again for more"
    )
    arguments.add_argument("--sample", type=int, help="so many mutants, drawn from all of the modules")
    arguments.add_argument("--seed", type=int, default=0, help="of that draw")
    given = arguments.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    modules = given.module or list(MODULES)
    chosen = [mutant for module in modules for mutant in mutants(module, (ROOT / module).read_text())]
    if given.sample is not None and given.sample < len(chosen):
        drawn = np.random.default_rng(given.seed).choice(len(chosen), given.sample, replace=False)
        chosen = [chosen[index] for index in sorted(drawn)]
    for name in HEAVY:
        importlib.import_module(name)
    argued = yaml.safe_load(ARGUED.read_text()) or {} if ARGUED.exists() else {}
    killed_of_all, survivors = 0, []
    for module in modules:
        its = [mutant for mutant in chosen if mutant.module == module]
        fates = judged(module, its, given.out / "mutants.jsonl")
        alive = [name.rsplit(" @", 1)[0] for name, outcome in fates.items() if outcome == "passed"]
        killed_of_all += len(its) - len(alive)
        survivors += alive
        print(f"{module}: {len(its) - len(alive)}/{len(its)} killed", flush=True)
    print(f"all: {killed_of_all}/{len(chosen)} killed")
    for name in survivors:
        reason = argued.get(name)
        print(name + (f"  (equivalent: {reason})" if reason else ""))
    return 0


if __name__ == "__main__":
    sys.exit(main())
