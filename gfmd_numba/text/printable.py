"""Text of users and their files, made harmless to a terminal."""


def printable(text: object) -> str:
    r"""Text of an object with everything that is not printable escaped: control characters, newlines, bidi overrides.

    A reader sees `\x1b` where a terminal would have obeyed the character.
    """
    return "".join(
        character if character.isprintable() else character.encode("unicode_escape").decode() for character in str(text)
    )
