"""One page of results: all that is told of them, their pictures, and nothing from elsewhere."""

import base64
import json
import re
import shutil
import subprocess
from functools import cache
from html import unescape
from html.parser import HTMLParser

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.campaign.status import Progress
from gfmd_numba.cli.report import _parts
from gfmd_numba.cli.terminal import Table
from gfmd_numba.scene.document import read_document
from support.campaigns import campaign
from support.command_line import gfmd, refused, unfolded
from support.scenes import SCENE

VOID = {"meta", "img", "br", "source"}


class Page(HTMLParser):
    """A page taken apart: its text, where its tags lead, and whether all that opens is closed."""

    def __init__(self, path):
        super().__init__()
        self.text, self.sources, self.open = "", [], []
        self.feed(path.read_text(encoding="utf-8"))
        assert self.open == []
        self.text = unfolded(self.text)

    def handle_starttag(self, tag, attrs):
        self.sources += [value for name, value in attrs if name in ("src", "srcset", "href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data + " "


@pytest.fixture(scope="module")
def folder(undrawn, laws_that_hold, tmp_path_factory):
    """A campaign, scenes, and the results of the first of both."""
    folder = tmp_path_factory.mktemp("reports")
    campaign(folder, **{"grid:": "fit: {fixed: {eps_c: 1, eps_f: 0.75}}\ngrid:"})
    (folder / "scene.yaml").write_text(SCENE)
    (folder / "path.yaml").write_text(SCENE + "path: [{reduced_pressure: 0.2}, {reduced_pressure: 0.1}]\n")
    (folder / "broken.yaml").write_text(SCENE + "numerics: {max_iterations: 1}\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for command in ("run campaign.yaml --workers=0 -o small", "solve scene.yaml -o contact.nc"):
            assert gfmd(*command.split()).exit_code == 0
    return folder


OTHERS = {
    "path.nc": "solve path.yaml",
    "broken.nc": "solve broken.yaml",
    "curve.nc": "curve scene.yaml --loads 0.05:0.2:3",
    "fit.nc": "fit small",
}


@pytest.fixture(scope="module")
def results_in(folder):
    """Find results of one kind, which are computed once."""

    def found(name):
        if not (folder / name).exists():
            command, file, *options = OTHERS[name].split()
            assert gfmd(command, folder / file, *options, "-o", folder / name).exit_code in (0, 3)
        return folder / name

    return found


@pytest.fixture(scope="module")
def page_of(results_in):
    """Write the page of one of the results, once."""

    @cache
    def written(name):
        page = results_in(name).with_name(f"{name}.html")
        assert gfmd("report", results_in(name), "-o", page).exit_code == 0
        return page

    return written


@pytest.fixture
def no_pictures(monkeypatch):
    monkeypatch.setattr("gfmd_numba.cli.report._drawn", lambda dataset, fitted: [])


@pytest.mark.parametrize(
    "name",
    [
        "contact.nc",
        *(pytest.param(name, marks=pytest.mark.long) for name in ("small", "path.nc", "curve.nc", "fit.nc")),
    ],
)
def test_a_page_needs_no_other_file(page_of, name):
    read = Page(page_of(name))
    assert read.sources
    for source in read.sources:
        assert base64.b64decode(source.removeprefix("data:image/png;base64,"), validate=True).startswith(b"\x89PNG")
    for heading in ("What came out", "How sure that is", "What was asked", "Where it comes from"):
        assert heading in read.text
    assert "No warning" in read.text
    assert "reloads itself" not in read.text


@pytest.mark.long
def test_a_phone_has_pictures_of_one_column(results_in, tmp_path, monkeypatch):
    def png(figure, dots=None):
        return base64.b64encode(f"{figure.get_figwidth():.1f} inches".encode()).decode()

    page = tmp_path / "page.html"
    monkeypatch.setattr("gfmd_numba.cli.report._png", png)
    assert gfmd("report", results_in("curve.nc"), "-o", page).exit_code == 0
    drawn = [base64.b64decode(each.partition(",")[2]) for each in Page(page).sources]
    assert drawn == [b"3.4 inches", b"9.6 inches"]
    assert '<source media="(max-width: 34rem)" srcset="data:image/png;base64,' in page.read_text()


@pytest.mark.long
def test_a_page_says_what_the_fit_prints(folder, page_of):
    printed = gfmd("fit", folder / "small").output
    read = Page(page_of("small"))
    for value in re.findall(r"\d\.\d+±\d\.\d+", printed):
        assert value in read.text
    with xr.open_dataset(folder / "small" / "small.nc") as dataset:
        assert unfolded(dataset.attrs["campaign"]) in read.text
        assert dataset.attrs["content_sha256"] in read.text


def test_a_page_of_a_contact_says_what_solve_prints_and_which_scene_it_was(folder, page_of, tmp_path):
    page = page_of("contact.nc")
    printed = gfmd("solve", folder / "scene.yaml", "-o", tmp_path / "again.nc").output.splitlines()[1:]
    read = Page(page)
    assert printed
    for line in printed:
        assert unfolded(line) in read.text
    asked = unescape(re.search(r"<pre>(.*?)</pre>", page.read_text(), re.DOTALL)[1])
    (tmp_path / "same.yaml").write_text(asked)
    same = gfmd("solve", tmp_path / "same.yaml", "-o", tmp_path / "same.nc")
    assert same.output.splitlines()[1:] == printed


WRITTEN = """\
scene:
  length: 0.2 mm                 # of the specimen
  body: {youngs_modulus: 70 GPa, poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.02}
  interface: {hard_wall: {}}
  loading: {pressure: 50 MPa}
discretisation: {eps_c: 1/2, eps_f: 1/8, eps_t: 1}
"""


@pytest.mark.filterwarnings("ignore:The contact is that of a profile", "ignore:The flow factor")
def test_a_page_shows_the_scene_as_its_user_wrote_it(no_pictures, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(WRITTEN)
    assert gfmd("curve", "scene.yaml", "--loads", "20MPa:50MPa:2", "-o", "curve.nc").exit_code == 0
    assert gfmd("report", "curve.nc").exit_code == 0
    page = (tmp_path / "curve.html").read_text()
    assert unescape(re.search(r"<pre>(.*?)</pre>", page, re.DOTALL)[1]) == WRITTEN
    contact = gfmd_numba.solve("scene.yaml")
    functions = ("contact_statistics", "leakage", "contact_conductance", "body_fields")
    for made in (getattr(gfmd_numba, name)(contact) for name in functions):
        assert made.attrs["yaml"] == contact.attrs["yaml"] == WRITTEN


def test_a_scene_of_python_is_shown_as_yaml_with_numbers_as_people_write_them(tmp_path):
    body = {"youngs_modulus": 70e9, "poissons_ratio": np.float64(0.1 + 0.2)}
    scene = {"length": "0.2 mm", "body": body, "interface": {"hard_wall": {}}, "loading": {"pressure": "1 GPa"}}
    scene["roughness"] = {"units": {"z": "um"}}
    solved = gfmd_numba.solve(scene, heights=0.1 * np.cos(np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)))
    lines = solved.attrs["yaml"].splitlines()
    for line in (
        "  length: 0.2 mm",
        "  body: {youngs_modulus: 7.0e+10, poissons_ratio: 0.30000000000000004}",
        "  loading: {pressure: 1 GPa}",
        "    heights: '...'",
    ):
        assert line in lines
    (tmp_path / "again.yaml").write_text(solved.attrs["yaml"])
    assert read_document(tmp_path / "again.yaml").data["scene"]["body"] == body


@pytest.mark.parametrize(
    "name",
    [
        "small",
        "contact.nc",
        *(pytest.param(name, marks=pytest.mark.long) for name in ("path.nc", "curve.nc", "fit.nc")),
    ],
)
def test_every_word_of_a_table_and_every_symbol_is_explained(page_of, name):
    content = unescape(page_of(name).read_text())
    told, meant = re.search("<h2>What came out(.*?)<h2>.*<h2>What the words mean(.*?)<h2>", content, re.DOTALL).groups()
    meanings = dict(re.findall(r"<dt>(.*?)</dt><dd>(.*?)</dd>", meant))
    words = [re.sub(r" \([^()]*\)$", "", heading) for heading in re.findall('<th scope="col">(.*?)</th>', told)]
    words = words or re.findall("<dt>(.*?)</dt>", told)
    assert set(words) - {"note"} <= meanings.keys()
    for symbol in ("a_r", "g", "E*", "L_x"):
        if re.search(rf"(?<!\w){re.escape(symbol)}(?!\w)", meant):
            assert symbol in meanings


def test_a_page_says_first_what_was_pressed(no_pictures, undrawn, tmp_path):
    page = tmp_path / "page.html"
    (tmp_path / "seal.yaml").write_text(
        "scene:\n  length: 2 mm\n  body: {youngs_modulus: 3 MPa, poissons_ratio: 0.5}\n"
        "  form: {radius: 10 mm, points: 64}\n  interface: {hard_wall: {}}\n  loading: {pressure: 10 kPa}\n"
    )
    assert gfmd("solve", tmp_path / "seal.yaml", "-o", tmp_path / "seal.nc").exit_code == 0
    assert gfmd("report", tmp_path / "seal.nc", "-o", page).exit_code == 0
    said = "Smooth profile with a form, 2 mm long, on a half-space of Young's modulus 3 MPa, under 10 kPa."
    assert said in Page(page).text


def test_a_contact_that_is_not_ok_is_warned_of(no_pictures, page_of):
    read = Page(page_of("broken.nc"))
    assert "1 of 1 ended as steps_used_up" in read.text
    assert "No warning" not in read.text


@pytest.mark.long
def test_names_are_text_and_no_markup(folder, no_pictures, tmp_path):
    with xr.open_dataset(folder / "contact.nc") as dataset:
        dataset.load().assign_attrs(title="<script>alert(1)</script>", validity="a < b & c").to_netcdf(
            tmp_path / "x.nc"
        )
    assert gfmd("report", tmp_path / "x.nc").exit_code == 0
    content = (tmp_path / "x.html").read_text()
    assert "<script" not in content
    assert "a &lt; b &amp; c" in content


def test_a_page_of_ours_is_written_again_and_no_other(folder, no_pictures, tmp_path):
    page = tmp_path / "page.html"
    for _ in range(2):
        assert gfmd("report", folder / "contact.nc", "-o", page).exit_code == 0
    page.write_text(page.read_text() + "<p>mine</p>")
    mine = page.read_bytes()
    assert "somebody has changed since" in refused("report", folder / "contact.nc", "-o", page)
    assert page.read_bytes() == mine
    assert "gfmd allows a page, ending in .html" in refused(
        "report", folder / "contact.nc", "-o", tmp_path / "page.pdf"
    )


def test_a_page_of_a_run_that_goes_on_reloads_itself_until_it_has_ended(folder, no_pictures, tmp_path, monkeypatch):
    page, seen = tmp_path / "page.html", []
    states = iter([True, False])

    def progress(directory):
        return Progress("small", next(states), 10, 4, {}, 90.0, {}, None)

    def sleep(seconds):
        seen.append(page.read_text())

    monkeypatch.setattr("gfmd_numba.campaign.status.progress", progress)
    monkeypatch.setattr("gfmd_numba.cli.report.sleep", sleep)
    assert gfmd("report", folder / "small", "-o", page, "--watch").exit_code == 0
    (content,) = seen
    assert 'http-equiv="refresh"' in content
    assert "4 of 10 blocks are done, about 90 s left" in content
    assert 'http-equiv="refresh"' not in page.read_text()
    assert "and its limit" in Page(page).text


@pytest.mark.long
def test_a_table_too_wide_for_a_phone_names_each_number_and_a_short_one_stays_a_table(page_of):
    (table,) = re.findall("<table.*?</table>", page_of("curve.nc").read_text(), re.DOTALL)
    assert table.startswith('<table class="stacked">')
    headings = re.findall('<th scope="col">(.*?)</th>', table)
    assert re.findall('<td data-column="(.*?)">', table) == 3 * headings
    short = Table("steps", {"step": ["0", "1"]}, {"area": ["0.1", "0.2"], "gap (nm)": ["100", "50"]})
    (part,) = _parts([short])
    assert not part["stacked"]


LOOK = """onload = () => document.title = JSON.stringify([...document.querySelectorAll("iframe")].map((frame) => {
    const inside = frame.contentDocument, tables = [...inside.querySelectorAll(".scroll")];
    const scrolled = tables.filter((each) => each.scrollWidth > each.clientWidth).length;
    return [scrolled, inside.documentElement.scrollWidth - frame.width];
}))"""


@pytest.mark.long
@pytest.mark.skipif(shutil.which("chromium") is None, reason="no chromium (apt-get install chromium)")
def test_no_page_is_wider_than_its_window_and_no_table_scrolls_sideways(page_of, tmp_path):
    """On a phone, and at a desk."""
    shown = [*((name, 390) for name in ("small", "path.nc", "curve.nc", "fit.nc")), ("small", 1280)]
    frames = ""
    for name, width in shown:
        shutil.copy(page_of(name), tmp_path / f"{name}.html")
        frames += f'<iframe src="{name}.html" width="{width}" height="900"></iframe>'
    (tmp_path / "frames.html").write_text(f"{frames}<script>{LOOK}</script>")
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files", "--dump-dom"]
    address = (tmp_path / "frames.html").as_uri()
    done = subprocess.run(["chromium", *options, address], capture_output=True, text=True, timeout=120)
    found = json.loads(re.search(r"<title>(.*?)</title>", done.stdout)[1])
    for (name, width), (scrolled, wider) in zip(shown, found, strict=True):
        assert scrolled == 0, f"{name} at {width} px"
        assert wider <= 0, f"{name} at {width} px"
