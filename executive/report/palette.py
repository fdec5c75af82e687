"""One restrained palette for every figure of a report; ink follows the page, which may be light or dark."""

INK = "var(--ink, #20262d)"
MUTED = "#66707a"
GRID = "#e3e6e8"
PAPER = "#ffffff"
TRUTH = INK
ESTIMATE = "#2a6fb5"
FIX = "#d9661f"
ON_TRACK = "#3f8f6b"
OFF_TRACK = "#d7a13a"
BAD = "#b5392f"
GOOD = "#3f8f6b"
BUSY = "#9dbbd8"
STRATEGY = "#7b4f9d"
FAULT = "#b5392f"
STATUS = {"running": BUSY, "success": GOOD, "failure": BAD, "invalid": "#c9ced2"}
# hypotheses in order of first appearance; the nominal one is always the first and pale
SERIES = ("#cfdcd3", "#d9661f", "#2a6fb5", "#7b4f9d", "#b5392f", "#d7a13a", "#5b8c8a", "#8a6d4b", "#a0a7ad")
