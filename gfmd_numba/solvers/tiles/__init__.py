"""Contact of maps with a hard wall, on tiles: squares of 8 x 8 nodes, of which only those near the contact are kept.

The door is `newton.tile_newton`.
"""
