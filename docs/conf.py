"""The site of the documentation: `make docs`. Pages under docs/generated are written here, from
what the library says of itself."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent), str(HERE)]

import reference  # noqa: E402

import irb2400_ctrl  # noqa: E402

project = "irb2400_ctrl"
version = release = irb2400_ctrl.__version__
extensions = ["myst_nb"]  # with myst_parser
# a notebook that fails, fails the build; what it writes goes to a folder of its own
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_in_temp = True
nb_execution_timeout = 600
nb_number_source_lines = False
nb_merge_streams = True
myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = f"irb2400_ctrl {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_copyright = False
html_last_updated_fmt = None
exclude_patterns = ["_build"]
# pages link to files of the repository too; that those are there, tests/test_readme.py holds
suppress_warnings = ["myst.xref_missing"]

reference.write(HERE / "generated")
