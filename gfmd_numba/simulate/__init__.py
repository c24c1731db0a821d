"""One file or record in, one dataset out."""
