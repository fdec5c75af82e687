"""Coverage: what a suite has made the trees do, what it has not, and why that may be so."""
