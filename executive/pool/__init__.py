"""The pool of recovery strategies: what each answers, needs, risks and costs, and which is tried."""

from executive.pool.choice import Attempt, Candidate, Choice
from executive.pool.known import DEFAULT_POLICY, known_policy, policy_names
from executive.pool.memory import Memory
from executive.pool.policies import FIRST_FITTED, Decision, Option, Policy
from executive.pool.pool import Pool
from executive.pool.situation import Situation
from executive.pool.strategy import Strategy, no_needs

__all__ = [
    "DEFAULT_POLICY",
    "FIRST_FITTED",
    "Attempt",
    "Candidate",
    "Choice",
    "Decision",
    "Memory",
    "Option",
    "Policy",
    "Pool",
    "Situation",
    "Strategy",
    "known_policy",
    "no_needs",
    "policy_names",
]
