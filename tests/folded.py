"""Text that was folded to the width of a terminal, as one line again."""


def unfolded(text):
    return " ".join(text.split())
