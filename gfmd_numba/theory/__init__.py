"""Closed forms and theories that simulations are checked against, and that choose their parameters."""
