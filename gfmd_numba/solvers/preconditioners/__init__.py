"""Approximate inverses of the compliance on the nodes in contact."""
