"""Settings of Sphinx for the documentation site."""

from pathlib import Path

from docutils.nodes import SkipNode
from latex2mathml.converter import convert
from sphinx.search.en import SearchEnglish

import gfmd_numba

project = "gfmd-numba"
author = "gfmd-numba maintainers"
version = release = gfmd_numba.__version__
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.viewcode"]
myst_enable_extensions = ["dollarmath"]
html_math_renderer = "mathml"  # browsers draw it themselves: no script, no network
napoleon_google_docstring = False
html_theme = "furo"
html_show_copyright = False
html_title = f"gfmd-numba {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_js_files = ["blocks.js"]
html_search_scorer = str(Path(__file__).with_name("scorer.js"))
SearchEnglish.stopwords -= {"only", "until"}  # options, which readers look for
default_role = "code"  # docstrings write code in single backticks
nitpicky = False
myst_heading_anchors = 4
nb_execution_mode = "off"  # the notebooks hold their outputs; the tests execute them
autodoc_typehints = "signature"
autodoc_member_order = "bysource"
autodoc_default_options = {"show-inheritance": False}
exclude_patterns = ["docs/site"]


def setup(app):
    """Write formulas as MathML; keep the bars of docstrings, which are absolute values and no substitutions."""
    app.add_html_math_renderer("mathml", (_write_formula("inline"), None), (_write_formula("block"), None))
    app.connect("autodoc-process-docstring", _escape_bars)


def _write_formula(display):
    """Return a visitor that writes a formula within a line, or on a line of its own."""

    def visit(translator, node):
        formula = convert(node.astext(), display=display)
        translator.body.append(formula if display == "inline" else f'<div class="formula">{formula}</div>')
        raise SkipNode

    return visit


def _escape_bars(app, what, name, obj, options, lines):
    """Escape bars outside code, which is every second part between backticks, and outside examples."""
    for i, line in enumerate(lines):
        if line.lstrip().startswith((">>>", "...")):
            continue
        parts = line.split("`")
        parts[::2] = [part.replace("|", "\\|") for part in parts[::2]]
        lines[i] = "`".join(parts)
