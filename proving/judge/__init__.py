"""What a run is judged by: expectations, temporal logic, safety; and the verdict on a case (`verdict`)."""

from proving.judge.expect import Expect, JudgeKeys
from proving.judge.instrument import INSTRUMENT

__all__ = ["INSTRUMENT", "Expect", "JudgeKeys"]
