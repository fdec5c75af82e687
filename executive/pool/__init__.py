"""The pool of recovery strategies: what each answers, needs, risks and costs, and which is tried."""
