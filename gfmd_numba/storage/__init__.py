"""Where things are kept: cache folders, compiled kernels, and files written whole or not at all."""
