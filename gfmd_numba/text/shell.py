"""Paths as words of a shell, so that a command that gfmd prints can be pasted, whatever a path is called."""

import shlex
from pathlib import Path


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
