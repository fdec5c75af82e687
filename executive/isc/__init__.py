"""In-situ classification: predict, compare, weigh hypotheses, extrapolate (paper, section 3.2)."""
