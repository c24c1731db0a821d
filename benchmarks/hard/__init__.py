"""Parts of the table of hard cases, by subject."""
