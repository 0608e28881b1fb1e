"""Files from strangers as text: bounded in size and depth, own errors only."""

from irb2400_ctrl.reading.bounded_text import bounded_text, toml_tables
from irb2400_ctrl.reading.looks_like import looks_like
from irb2400_ctrl.reading.text_blocks import text_blocks
from irb2400_ctrl.reading.xml_root import xml_root

__all__ = ["bounded_text", "looks_like", "text_blocks", "toml_tables", "xml_root"]
