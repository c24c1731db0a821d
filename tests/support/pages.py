"""What pages print to be typed: blocks and command lines in the order of the page, and files that they speak of."""

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
PROGRAMS = ("gfmd", "python", "pip", "openssl", "chmod", "export", "TLS=", "dask", "docker", ".venv", "conda", "twine")
_FENCE = re.compile(r"^( *)```(\w*)\n(.*?)\n\1```$", re.MULTILINE | re.DOTALL)
_INDENTED = re.compile(r"(?<=\n\n)(?:    \S.*\n)+")
_INLINE = re.compile(r"`((?:gfmd|python)\s[^`]+)`")
_FILE = re.compile(r"# (?:(excerpts?) of )?([\w-]+\.yaml)(?:, under (\w+))?(, one a line)?(?:[:;].*)?\n")


@dataclass(frozen=True)
class Printed:
    """One block or one command, and where it stands."""

    page: Path
    line: int
    kind: str  # the language of a block, or `command`
    text: str
    inline: bool = False

    def __str__(self):
        return f"{self.page.name}:{self.line}: {self.text.splitlines()[0]}"


def printed(page):
    """Everything on a page that a reader may type, in order."""
    text = page.read_text(encoding="utf-8")

    def at(match, kind, content, inline=False):
        return Printed(page, text.count("\n", 0, match.start()) + 1, kind, content, inline)

    found = []
    for fence in _FENCE.finditer(text):
        kind, content = fence[2], re.sub(f"^{fence[1]}", "", fence[3], flags=re.MULTILINE)
        if kind == "sh":
            found += [at(fence, "command", line) for line in _lines(content)]
        else:
            found.append(at(fence, kind, content + "\n"))
    prose = _FENCE.sub(lambda fence: re.sub(r"[^\n]", " ", fence[0]), text)  # as long as it was
    for block in _INDENTED.finditer(prose):
        if block[0].lstrip().startswith(PROGRAMS):
            found += [at(block, "command", line) for line in _lines(block[0])]
    found += [at(inline, "command", " ".join(inline[1].split()), inline=True) for inline in _INLINE.finditer(prose)]
    return sorted(found, key=lambda item: item.line)


def _lines(block):
    return [line.split("  #")[0].strip() for line in block.splitlines()]


def files_of(item, known):
    """Name and content of each YAML file that a block prints, or completes an earlier one to; {} if it names none."""
    head = _FILE.match(item.text)
    assert head, f"{item}: the first line names no file"
    excerpt, name, under, apart = head.groups()
    body = item.text[head.end() :]
    if excerpt is None:
        return [(name, yaml.safe_load(body))]
    parts = [line for line in body.splitlines() if line.strip()] if apart else [body]
    return [(name, _completed(known[name], yaml.safe_load(part), under)) for part in parts]


def _completed(whole, part, under):
    part = {under: part} if under else part
    return whole | {key: whole[key] | value if key == "scene" else value for key, value in part.items()}


def words(command):
    """Words of a command line whose choices in brackets are left out."""
    return shlex.split(re.sub(r"\[[^]]*\]", "", command))


def options(command):
    """Every option that a command line names, also those in brackets."""
    return re.findall(r"(?<=[\s[])--[a-z][a-z-]*", command)


_LARGEST = {1: 1024, 2: 32}  # nodes along a side that a test solves as printed
_EPS = ("eps_c", "eps_f", "eps_t")


def smaller(record):
    """The same file with fewer levels, cases and surfaces, and with grids so small that it takes a second."""
    record = yaml.safe_load(yaml.safe_dump(record))
    groups = [record.get("reference") or record.get("discretisation") or {}]
    limits = record.get("limits", {})
    for eps, levels in limits.items():
        limits[eps] = levels[: 3 if eps == "eps_f" else 2]
    groups += [limits, *limits.get("cross", []), record.get("grid", {})]
    found = sorted({_number(value) for group in groups for value in _listed(group.get("eps_f"))}, reverse=True)
    finest = {eps: min(_number(v) for group in groups for v in _listed(group.get(eps, 1))) for eps in _EPS}
    dimension = record.get("scene", {}).get("dimension", 1)
    if found and 2 / np.prod(list(finest.values())) > _LARGEST[dimension]:
        ladder = {value: 0.5 ** (rank + (1 if len(found) > 1 else 2)) for rank, value in enumerate(found)}
        for group in groups:
            if "eps_f" in group:
                value = group["eps_f"]
                small = [ladder[_number(each)] for each in _listed(value)]
                group["eps_f"] = small if isinstance(value, list) else small[0]
    if "realisations" in record:
        record["realisations"] = 8 if limits else 2
    known = record.get("fit", {}).get("fixed", {})
    known |= {eps: sum(map(_number, each)) / 2 for eps, each in known.items() if isinstance(each, list)}
    if "target" in record:
        record["target"] = dict.fromkeys(record["target"], 0.3)
        if dimension == 2 and not found:  # a run that chooses its levels would solve hundreds of large maps
            record["scene"]["dimension"] = 1
    if "grid" in record:
        axes = enumerate(record["grid"].items())
        several = not limits and "path" not in record
        record["grid"] = {name: values[: 2 if several and not rank else 1] for rank, (name, values) in axes}
        if "target" in record and not found:  # a run that chooses its levels takes seconds for each case
            record["grid"] = {name: values[-1:] for name, values in record["grid"].items()}
    if record.get("dimension") == 2:
        record["surface"]["points"] = _LARGEST[2]
    return record


def _listed(value):
    return [] if value is None else value if isinstance(value, list) else [value]


def _number(value):
    above, _, below = str(value).partition("/")
    return float(above) / float(below or 1)


ELASTIC = {"youngs_modulus": 1e9, "poissons_ratio": 0.3, "aspect_ratio": 1}
SCENE = {
    "scene": {
        "length": 1e-4,
        "body": ELASTIC,
        "roughness": {"method": "psd", "hurst": 0.3, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.3},  # scatters little
    },
    "discretisation": {"eps_c": "1/4", "eps_f": "1/16", "eps_t": "1/2"},
}
MAP = {
    "scene": SCENE["scene"] | {"dimension": 2},
    "discretisation": {"eps_c": "1/4", "eps_f": "1/4", "eps_t": "1/2"},
}
CAMPAIGN = {
    "name": "campaign",
    "seed": 1,
    "realisations": 20,
    "scene": SCENE["scene"],
    "reference": {"eps_c": "1/2", "eps_f": "1/16", "eps_t": "1/2"},
    "limits": {"eps_c": [1, "1/4"], "eps_f": ["1/4", "1/64"]},
    "fit": {"fixed": {"eps_c": 2, "eps_f": 1}},
}
LOADS = CAMPAIGN | {"name": "loads", "grid": {"reduced_pressure": [0.1, 0.14, 0.2]}}
CLUSTER = {"cores": 2, "memory": "4 GB", "walltime": "1 h", "jobs": {"max": 2}}
# files that pages speak of without printing them
FILES = {
    "scene.yaml": SCENE,
    "map.yaml": MAP,
    "campaign.yaml": CAMPAIGN,
    "loads.yaml": LOADS,
    "cluster.yaml": CLUSTER,
}


def profile(points=1024, seed=0):
    """Heights in m of a ground surface of a millimetre."""
    waves = np.arange(1, points // 8)
    phases = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, waves.size)
    x = np.arange(points) / points
    return 3e-7 * (waves**-1.3 * np.cos(2.0 * np.pi * np.outer(x, waves) + phases)).sum(axis=1)
