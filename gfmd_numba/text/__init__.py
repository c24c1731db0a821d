"""Text that leaves the program: what users and their files wrote, made harmless."""
