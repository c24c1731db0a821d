"""Text of users and their files, made harmless to a terminal, and paths that can be pasted into a shell."""

import shlex
from pathlib import Path


def printable(text: object) -> str:
    r"""Return the text of an object with control characters, newlines and all else that is not printable escaped.

    A reader sees `\x1b` where a terminal would have obeyed the character.
    """
    return "".join(each if each.isprintable() else each.encode("unicode_escape").decode() for each in str(text))


def word(path: str | Path) -> str:
    """Return a path as one word of a shell that is a file and no option, and printable as it stands."""
    text = str(path)
    text = f"./{text}" if text.startswith("-") else text
    if text.isprintable():
        return shlex.quote(text)
    return f"$'{''.join(map(_escaped, text))}'"


def _escaped(character: str) -> str:
    """Return a character within the quotes $'...', which bash, zsh and ksh know."""
    if character in "\\'":
        return f"\\{character}"
    if character.isprintable():
        return character
    return "".join(f"\\x{byte:02x}" for byte in character.encode(errors="surrogateescape"))
