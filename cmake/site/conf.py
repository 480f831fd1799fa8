"""Settings of Sphinx for the site; cmake/site/build starts it."""

import os
import re

root = os.environ["TAUT_ROOT"]
project = "taut"
author = "The taut authors"
copyright = author
with open(f"{root}/CMakeLists.txt") as lists:
    version = release = re.search(r"^project\(taut VERSION ([\d.]+)", lists.read(), re.M)[1]

extensions = ["myst_nb", "autoapi.extension", "sphinx_copybutton"]
root_doc = "index"
nitpicky = False
exclude_patterns = []

# Pages are Markdown as GitHub has it; headings have the same anchors.
myst_heading_anchors = 6
myst_enable_extensions = ["dollarmath", "colon_fence"]
suppress_warnings = ["myst.header"]
highlight_language = "text"  # indented blocks are equations and commands
pygments_style = "friendly"

# Notebooks have been run already.  A reader may have no network: MathJax in one file, without fonts, is a part of the site.
nb_execution_mode = "off"
html_static_path = ["node_modules/mathjax/es5/tex-svg-full.js"]
mathjax_path = "tex-svg-full.js"

# The reference of Python, from the stub of the module.
autoapi_dirs = [f"{root}/build/site/python"]
autoapi_root = "api/python"
autoapi_file_patterns = ["*.pyi"]
autoapi_options = ["members", "undoc-members", "special-members"]
autoapi_member_order = "bysource"
autoapi_add_toctree_entry = False
autoapi_keep_files = False
autoapi_own_page_level = "class"
autoapi_python_class_content = "both"
add_module_names = False

html_theme = "furo"
html_title = f"taut {release}"
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}
html_last_updated_fmt = None
html_search_scorer = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scorer.js")
