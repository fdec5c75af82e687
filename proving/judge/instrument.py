"""The instrument that owns `expect` and `expected_to_fail`, and judges the safety of every run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from executive.config.source import Source
from executive.config.validate import parse
from executive.core.errors import Problem
from executive.record import JudgedRow
from executive.run import InstrumentSpec, Judgement, Records, Schema, Setting, strange_nodes
from executive.tree.spec import TreeSpec
from proving.inject import INSTRUMENT as FAULTS
from proving.judge.expect import LISTS, Expect, JudgeKeys, with_lists
from proving.judge.expectations import judge
from proving.judge.expected import expect_problems, steps
from proving.judge.safety import safety_rows


class Expectations(InstrumentSpec[JudgeKeys]):
    """Settings: what the run must come to, and why it does not yet."""

    name = "expect"
    doc = "Judges a run by what its scenario expects, and by what must hold of every run."
    keys = tuple(JudgeKeys.model_fields)
    after = (FAULTS.name,)

    def expand(self, source: Source) -> Source:
        return with_lists(source)

    def read(self, source: Source, setting: Setting) -> JudgeKeys:
        return parse(source, JudgeKeys)

    def check(
        self, source: Source, settings: Mapping[str, object], tree: TreeSpec | None
    ) -> Iterable[Problem]:
        return _problems(source, settings, tree)

    def dump(self, settings: JudgeKeys) -> dict[str, object]:
        return settings.model_dump(mode="json", by_alias=True, exclude_none=True)

    def schema(self, defs: Schema) -> dict[str, Schema]:
        made = JudgeKeys.model_json_schema(by_alias=True)
        defs |= made["$defs"]
        expect = defs["Expect"]["properties"]
        for name in LISTS:
            several = {key: expect[name].pop(key) for key in ("type", "items")}
            expect[name]["anyOf"] = [several["items"], several]
        return dict(made["properties"])

    def judge(self, settings: JudgeKeys, records: Records) -> Judgement:
        result, history, truth = records.result, records.history, records.truth
        rows = tuple(judge(settings.expect, result, history, truth))
        safety = tuple(safety_rows(history, truth, records.rig))
        return Judgement(rows, safety, met(settings.expect, result.outcome, rows, safety))


INSTRUMENT = Expectations()


def met(expect: Expect, outcome: str, rows: Sequence[JudgedRow], safety: Sequence[JudgedRow]) -> bool | None:
    """Whether a run was as it should be: all it was expected to come to, and safe.

    None where nothing was expected, or where the run proves nothing. An error must itself be expected.
    """
    if outcome == "invalid" or not rows:
        return None
    kept = all(row.met for row in rows) and all(row.met is not False for row in safety)
    return kept and (outcome != "error" or outcome in expect.outcome)


def _problems(source: Source, settings: Mapping[str, object], tree: TreeSpec | None) -> Iterator[Problem]:
    faults = settings.get(FAULTS.name)
    names = [fault.name for fault in faults] if isinstance(faults, tuple) else None
    yield from expect_problems(source, names)
    if tree is not None:
        yield from strange_nodes(source, steps(source), tree)
