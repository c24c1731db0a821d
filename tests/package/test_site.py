"""The site in a browser, on a phone and on a desk: nothing is too wide or cut off, no picture or formula is missing."""

import html
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
OPTIONS = ["--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files"]
OFFLINE = "--host-resolver-rules=MAP * ~NOTFOUND"
WIDTHS = (390, 1280)
# looks at each page in its frame, and writes down what a reader could not see
LOOK = r"""
onload = () => {
    const faults = [];
    for (const frame of document.querySelectorAll("iframe")) {
        const inside = frame.contentDocument, width = frame.width, wide = inside.documentElement.scrollWidth;
        const fault = (what) => faults.push(`${frame.title} at ${width} px: ${what}`);
        if (wide > width) fault(`is ${wide} px wide`);
        for (const box of inside.querySelectorAll("article pre, article .table-wrapper, article .formula"))
            if (box.scrollWidth > box.clientWidth + 1) fault(`cuts off ${box.innerText.slice(0, 60)}`);
        for (const box of inside.querySelectorAll("article pre, article td"))
            if (box.innerText && parseFloat(getComputedStyle(box).fontSize) < 6.4)
                fault(`has tiny ${box.innerText.slice(0, 60)}`);
        const texts = inside.createTreeWalker(inside.body, NodeFilter.SHOW_TEXT);
        while (texts.nextNode()) {
            const text = texts.currentNode, range = inside.createRange();
            if (/(^|\s)\u2013\w/.test(text.data)) fault(`makes a dash of an option in ${text.data}`);
            for (const option of text.parentElement.closest("pre, code") ? text.data.matchAll(/--\w[\w-]*/g) : []) {
                range.setStart(text, option.index);
                range.setEnd(text, option.index + option[0].length);
                if (range.getClientRects().length > 1) fault(`breaks ${option[0]}`);
            }
        }
        for (const picture of inside.querySelectorAll("article img")) {
            if (!picture.naturalWidth) fault(`lacks ${picture.src}`);
            if (picture.getBoundingClientRect().right > width) fault(`cuts off ${picture.src}`);
        }
        for (const formula of inside.querySelectorAll("article math")) {
            const {width: across, height: high} = formula.getBoundingClientRect();
            if (!across || !high) fault(`does not draw ${formula.textContent}`);
            if (across > width) fault(`cuts off ${formula.textContent}`);
        }
        if (inside.querySelector("merror, article .math")) fault("has formulas that are not typeset");
        if (/\u00a9\s*$/m.test(inside.body.innerText)) fault("names no holder of rights");
        const blocks = [...inside.querySelectorAll("article div.highlight pre")];
        const copied = blocks.filter((block) => !block.closest(".highlight-text, .output"));
        if (inside.querySelectorAll("button.copy").length !== copied.length) fault("lacks a copy button");
        const clipboard = [];
        const writeText = async (text) => clipboard.push(text);
        Object.defineProperty(inside.defaultView.navigator, "clipboard", {value: {writeText}});
        for (const button of inside.querySelectorAll("button.copy")) button.click();
        if (clipboard.length !== copied.length) fault("has a button that copies nothing");
        for (const text of clipboard.filter((each) => />>>|\\\|/.test(each))) fault(`copies ${text}`);
    }
    document.title = JSON.stringify(faults);
};
"""


def opened(address, *options):
    """Return what Chromium has made of a page."""
    command = ["chromium", *OPTIONS, OFFLINE, *options, "--dump-dom", address]
    return subprocess.run(command, capture_output=True, text=True, timeout=300).stdout


def _prose(page):
    """Text of a page without its blocks and code."""
    text = re.sub(r"^ *```.*?^ *```$", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"^    .*$|`[^`]*`", "", text, flags=re.MULTILINE)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    pytest.importorskip("sphinx", reason="the extra `docs` is not installed")
    folder = tmp_path_factory.mktemp("site")
    subprocess.run([sys.executable, str(ROOT / "docs/site/build.py"), str(folder)], check=True, timeout=300)
    return folder


@pytest.mark.long
def test_the_site_is_built_without_a_warning(site):
    assert (site / "index.html").is_file()


@pytest.mark.long
@pytest.mark.skipif(shutil.which("chromium") is None, reason="no chromium (apt-get install chromium)")
def test_a_reader_sees_all_of_every_page_and_finds_it(site):
    pages = sorted(str(path.relative_to(site)) for path in site.rglob("*.html") if "_modules" not in path.parts)
    assert pages
    typeset = {page for page in pages if "<math " in (site / page).read_text(encoding="utf-8")}
    written = {f"docs/{page.stem}.html" for page in (ROOT / "docs").glob("*.md") if "$" in _prose(page)}
    assert written
    assert written <= typeset
    frame = '<iframe src="{0}" title="{0}" width="{1}" height="900"></iframe>'
    frames = "".join(frame.format(page, width) for page in pages for width in WIDTHS)
    (site / "look.html").write_text(f"<!doctype html><title></title><script>{LOOK}</script>{frames}")
    faults = re.search(r"<title>(.*?)</title>", opened((site / "look.html").as_uri()), re.DOTALL)[1]
    assert json.loads(html.unescape(faults)) == []
    found_in = {"hardness": "hardness", "spikes": "surfaces", "until": "campaigns", "residual": "terms"}
    for word, page in found_in.items():
        said = opened(f"{(site / 'search.html').as_uri()}?q={word}", "--virtual-time-budget=5000")
        results = re.findall(r'<li class="kind-.*?<a href="([^"#]*)', said, re.DOTALL)
        assert f"docs/{page}.html" in results[:3]
