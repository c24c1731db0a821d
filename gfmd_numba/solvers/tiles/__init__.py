"""Contact of maps with a hard wall, on the tiles that the contact may reach; its door is `newton.tile_newton`."""
