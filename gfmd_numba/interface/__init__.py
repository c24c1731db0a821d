"""Laws that act between the surfaces."""
