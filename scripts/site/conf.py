"""Sphinx settings of the site; `build.py` runs Sphinx with them."""

from importlib import metadata

project = "thbridge"
author = "the authors of thbridge"
version = release = metadata.version("thbridge")
copyright = author  # noqa: A001 - Sphinx' name

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["pictures", "sweeps", "learning", "launch"]

myst_enable_extensions = ["colon_fence", "deflist"]
# Anchors of headings are the same as on GitHub.
myst_heading_anchors = 4

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True}
python_use_unqualified_type_names = True
napoleon_use_ivar = True
napoleon_use_rtype = False
# Without this setting, Sphinx would replace the two hyphens of options such as --robots by a dash.
smartquotes = False
# Docstrings use single backquotes for code, as Markdown does.
default_role = "code"

html_theme = "furo"
html_title = "thbridge"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_js_files = ["versions.js"]
html_copy_source = False
html_show_sourcelink = False
# Search summaries are loaded from other pages. Browsers refuse this for pages on a local disk.
html_show_search_summary = False
html_theme_options = {"navigation_with_keys": True, "top_of_page_buttons": []}
