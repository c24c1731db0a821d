"""Numbers as other programs and countries write them, and how they are written here."""

import re

_DIGITS = r"[-+]?(?:\d+\.?\d*|\.\d+)"
_FORTRAN = re.compile(rf"\s*({_DIGITS})[dD]([-+]?\d+)(?!\d)")
_GROUPED = re.compile(r"\s*([-+]?\d{1,3}(?:([,'_ \u00a0\u202f])\d{3})(?:\2\d{3})*(?:\.\d*)?)(?![\d,'_])")
_DECIMAL_COMMA = re.compile(r"\s*([-+]?\d*),(\d+)(?!\d|,)")


def respelt(text: str) -> str:
    """How to write the number that a text begins with; nothing if it is written like that, or is no number."""
    if found := _FORTRAN.match(text):
        return f"exponents have an e: {found[1]}e{found[2]}"
    if found := _GROUPED.match(text):
        whole = re.sub("[^-+0-9.]", "", found[1])
        both = re.fullmatch(r"[-+]?\d+,\d{3}", found[1])
        other = f", or {found[1].replace(',', '.')} with a decimal point" if both else ""
        return f"thousands have no separator: {whole}{other}"
    if found := _DECIMAL_COMMA.match(text):
        return f"decimals have a point: {found[1] or 0}.{found[2]}"
    return ""
