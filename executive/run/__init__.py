"""From a scenario file to a finished run folder.

What other packages use of it stands here: scenarios resolved, instruments, the shapes of faults. The modules
`app` (what the commands do), `resolve` and `judging` are public too.
"""

from executive.run.fault import (
    CATEGORIES,
    FAULT_KIND,
    Cue,
    Fault,
    FaultSpec,
    every_fault,
    load_fault,
)
from executive.run.instrument import (
    Context,
    Instrument,
    InstrumentSpec,
    Judgement,
    Records,
    Schema,
    Setting,
    TreeParts,
)
from executive.run.kept_files import changes
from executive.run.resolved import ResolvedScenario
from executive.run.targets import Named, strange_nodes, strange_strategies, strange_values

__all__ = [
    "CATEGORIES",
    "FAULT_KIND",
    "Context",
    "Cue",
    "Fault",
    "FaultSpec",
    "Instrument",
    "InstrumentSpec",
    "Judgement",
    "Named",
    "Records",
    "ResolvedScenario",
    "Schema",
    "Setting",
    "TreeParts",
    "changes",
    "every_fault",
    "load_fault",
    "strange_nodes",
    "strange_strategies",
    "strange_values",
]
