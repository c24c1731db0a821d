"""The reference of the site documents every public name, every key of a YAML file, every command and observable."""

import inspect
import re
from typing import get_args

import pytest
import reference
from pydantic import BaseModel

import gfmd_numba
from gfmd_numba import analysis
from gfmd_numba.campaign.cluster import Cluster
from gfmd_numba.campaign.file import Campaign
from gfmd_numba.cli import main
from gfmd_numba.cli.inspection import schemas
from gfmd_numba.contact.observables import OBSERVABLES, PATH_OBSERVABLES
from gfmd_numba.scene import SceneFile
from gfmd_numba.scene.surface_file import SurfaceFile
from support.command_line import gfmd

FILES = {"campaign": Campaign, "scene": SceneFile, "surface": SurfaceFile, "cluster": Cluster}


def _records_in(annotation):
    if inspect.isclass(annotation) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in get_args(annotation):
        yield from _records_in(inner)


def _all_records():
    """Every record that a file may hold, found from the types and not from the schema."""
    found, to_do = set(), list(FILES.values())
    while to_do:
        record = to_do.pop()
        if record not in found:
            found.add(record)
            to_do += [inner for field in record.model_fields.values() for inner in _records_in(field.annotation)]
    return sorted(found, key=lambda record: record.__name__)


@pytest.fixture(scope="module")
def page():
    return reference.keys_page(schemas())


def _section(page, record):
    kinds = {record: kind for kind, record in FILES.items()}
    heading = f"## {reference._FILES[kinds[record]][0]}" if record in kinds else f"### {record.__name__}"
    return re.split(r"\n(?:\(key-\w+\)=\n)?##", page.partition(f"{heading}\n")[2])[0]


def _rows(section):
    rows = [re.split(r"(?<!\\)\|", line)[1:-1] for line in section.splitlines() if line.startswith("| `")]
    return {cells[0].strip(" `"): [cell.strip() for cell in cells[1:]] for cells in rows}


@pytest.mark.parametrize("record", _all_records(), ids=lambda record: record.__name__)
def test_every_key_is_documented_with_unit_and_allowed_values(page, record):
    rows = _rows(_section(page, record))
    assert rows.keys() == {field.alias or name for name, field in record.model_fields.items()}
    for key, (unit, allowed, default, meaning) in rows.items():
        assert len(meaning) >= 8, f"{key} has no meaning"
        assert allowed not in ("", "a number", "a whole number"), f"{key} has no range: {allowed}"
        assert default, key
        if re.match(r"(a list, each entry )?(a|whole) ?(whole )?number", allowed):
            assert unit != "-", f"{key} has no unit"


@pytest.mark.parametrize("module", [gfmd_numba, analysis], ids=lambda module: module.__name__)
def test_every_public_name_is_documented(module):
    assert f".. automodule:: {module.__name__}\n" in reference.python_page([])
    for name in module.__all__:
        if not name.startswith("__"):
            documentation = inspect.getdoc(getattr(module, name)) or ""
            assert documentation.split("\n")[0].endswith((".", ":")), name


def test_every_command_and_option_is_documented():
    page = reference.commands_page(main)
    for name, command in main.commands.items():
        assert f"## gfmd {name}\n" in page
        assert all(getattr(option, "help", "") for option in command.params if option.param_type_name == "option"), name


def test_every_observable_is_documented():
    page = reference.files_page().replace("\\", "")
    for name, row in (OBSERVABLES | PATH_OBSERVABLES).items():
        assert f"| `{name}` |" in page
        assert row.long_name in page


def test_the_page_of_commands_shows_their_help_as_they_print_it():
    page = reference.commands_page(main)
    assert page.count("-h, --help") == len(main.commands)
    assert gfmd("accuracy", "-h").exit_code == 0  # making the page leaves the commands as they were
