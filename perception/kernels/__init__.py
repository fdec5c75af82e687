"""The inner loops of perception in machine code. They compute; the modules they serve check and explain.

Arrays are C-contiguous float64 throughout (`plain` makes them so), as another kind means another compilation.
"""
