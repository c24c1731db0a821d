"""Text of users and their files, made harmless to a terminal."""


def printable(text: object) -> str:
    r"""Return the text of an object with control characters, newlines and all else that is not printable escaped.

    A reader sees `\x1b` where a terminal would have obeyed the character.
    """
    return "".join(
        character if character.isprintable() else character.encode("unicode_escape").decode() for character in str(text)
    )
