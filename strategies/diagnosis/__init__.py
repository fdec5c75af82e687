"""What the rover's classification weighs: hypotheses, and the channels that they show on.

Registered from outside the core; the order is that in which likelihoods are multiplied and weights summed.
"""
