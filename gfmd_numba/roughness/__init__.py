"""Rough surfaces: generators, the user's own profiles and their statistics."""
