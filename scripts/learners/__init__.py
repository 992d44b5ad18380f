"""Policies that choose rooms in environments, and a learner of a policy."""
