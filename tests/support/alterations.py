"""Text, values and bytes altered at random, by words and numbers that are apt to do harm."""

import re

import numpy as np
import yaml

_WORDS = """
NaN .nan .inf -.inf 1e400 -1e400 1e-400 0 -0.0 -0 1 -1 2 1/0 0/0 1/3 1e308 -1e308 1.7976931348623157e308 5e-324
-5e-324 9223372036854775808 -9223372036854775809 18446744073709551616 1e30 1e-30 -1e30 1e-12 0.5 0.49999999999999994
1e-7 1e7 '0.5' "1" "" '' "2D" true no ~ [] {} [[1]] [0.5,0.5] [.inf] [1,1,1] {a:1} &a *a <<:{}
!!python/object:os.system !<!%1b> ../../etc/passwd /dev/null /dev/zero p.npy p.nc . / "\\0" "\\e[2J\\n" "\\u202e" 名前
\u202e \x1b \x00 0x10 0o17 1_000 12:30:00 2001-01-01 - ? : # --- ... | > ` @ ' " 1e3.5 0.1e-1000000000 None null
{method:psd} {method:[psd]} root:*: .75 .99
"""
ODD = _WORDS.split()
ODD += [
    "1" * 400,
    "9" * 299 + "/" + "9" * 299,
    "é" * 5000,
    "[" * 200,
    "{a: " * 200,
    "1e-3 " * 1000,
    "1" * 20,
    "x" * 5000,
]
ENDS = [
    1e30,
    -1e30,
    1e-30,
    1e-12,
    0.5,
    0.01,
    1.0,
    0.99,
    -0.99,
    -0.9999999999999999,
    0.4999999999,
    100.0,
    1e-300,
    5e-324,
]
SIZES = [1e308, -1e308, 5e-324, -5e-324, 0.0, -0.0, np.nan, np.inf, -np.inf, 2.0**63, 1e30, -1e31, 1e-300, 1.0]


def changed_text(text, pick):
    """Text with one to five words, characters or lines replaced, repeated, moved or lost."""
    for _ in range(pick.choice([1, 1, 1, 1, 2, 5])):
        words, lines = list(re.finditer(r"[^\s{}\[\],:]+", text)), text.splitlines(keepends=True)
        if not words:
            return text
        word, other = pick.choice(words), pick.choice(words)
        line, at = pick.randrange(len(lines)), pick.randrange(len(text))
        kind = pick.choice([0, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6])
        if kind == 0:
            text = text[: word.start()] + pick.choice(ODD) + text[word.end() :]
        elif kind == 1:
            text = text[: word.start()] + other.group() + text[word.end() :]
        elif kind == 2:
            text = text[:at] + pick.choice("{}[],:#&*!|>'\"%@`\t\n -?\x7f\u2028\ufeff\xa0\x1b") + text[at:]
        elif kind == 3:
            text = text[:at] + text[at + pick.randrange(20) :]
        elif kind == 4:
            text = "".join([*lines[:line], lines[line], *lines[line:]])
        elif kind == 5:
            text = "".join([*lines[:line], " " * pick.randrange(6) + lines[line].lstrip(), *lines[line + 1 :]])
        else:
            text = text[:at]
    return text


def changed_number(text, pick):
    """Text with one to four numbers replaced by others that may well be allowed, near the ends of what is."""
    for _ in range(pick.choice([1, 1, 2, 4])):
        numbers = list(re.finditer(r"(?<![\w./])-?[0-9.]+(e-?[0-9]+)?(?![\w./])", text))
        number = pick.choice(numbers)
        near = float(number.group()) * 10.0 ** pick.uniform(-4.0, 4.0)
        other = pick.choice([near, near, -near, *ENDS])
        text = f"{text[: number.start()]}{other}{text[number.end() :]}"
    return text


def changed_value(text, pick):
    """YAML whose data have one to three values replaced by others of any kind and size, or taken away."""
    data = yaml.safe_load(text)
    for _ in range(pick.choice([1, 1, 1, 2, 3])):
        inside, key = pick.choice(list(_places(data)))
        if pick.random() < 0.1:
            del inside[key]
        else:
            inside[key] = pick.choice(
                [*SIZES, 2**63, "", [], {}, None, True, "\x1b[2J", [inside[key]], {"a": inside[key]}]
            )
        if not data:
            break
    return yaml.safe_dump(data, allow_unicode=False)


def _places(inside):
    """Every value of nested data, as what it is in and its key, outside in and in order."""
    for key in list(inside) if isinstance(inside, dict) else range(len(inside)):
        yield inside, key
        if isinstance(inside[key], dict | list):
            yield from _places(inside[key])


def changed_bytes(content, pick):
    """Content that lost its end, or some bytes of which were altered, zeroed or repeated, often near its beginning."""
    content = bytearray(content)
    for _ in range(pick.choice([1, 1, 1, 3])):
        at = pick.randrange(min(len(content), pick.choice([150, len(content)])) or 1)
        stop, kind = min(at + pick.randrange(1, 50), len(content)), pick.randrange(6)
        if kind == 0:
            content[at:] = b""
        elif kind == 1 and content:
            content[at] ^= 1 << pick.randrange(8)
        elif kind == 2 and content:
            content[at] = pick.randrange(256)
        elif kind == 3:
            content[at:stop] = bytes(stop - at)
        elif kind == 4:
            content[at:at] = content[at:stop]
        else:
            content[at:stop] = str(pick.choice([2**63, 10**30, -1, 0, ""])).encode()
    return bytes(content)
