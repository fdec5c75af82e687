from executive.core.ordered_sum import ordered_sum


def test_each_addition_is_rounded_on_its_own():
    assert ordered_sum([1e16, 1.0, 1.0]) == 1e16  # Python 3.12's sum() gives 1e16 + 2
    assert ordered_sum([1.0, 1.0, 1e16]) == 1e16 + 2


def test_nothing_sums_to_zero():
    assert ordered_sum([]) == 0.0
