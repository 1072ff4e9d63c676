"""Settings of the site: `make docs` builds it from the pages in this folder, without a network."""

from __future__ import annotations

import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

project = "greywhale"
author = "The greywhale authors"
project_copyright = author
version = release = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_click", "tools.docs.extension"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["derivation"]
html_theme = "furo"
html_title = f"greywhale {release}"
html_copy_source = html_show_sourcelink = False
templates_path: list[str] = []

# Headings have the anchors that they have on a forge, so that one link serves both.
myst_heading_anchors = 4
# page:STATE opens the page with a bench inside, which lies beside the site, in a state (link_to_state.ts).
myst_url_schemes = {"http": None, "https": None, "mailto": None, "page": "../index.html#{{path}}"}

smartquotes = False  # --option is no dash
default_role = "code"  # docstrings write `name`
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True, "undoc-members": True, "exclude-members": "model_config, model_post_init"}
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 100
nitpicky = False
