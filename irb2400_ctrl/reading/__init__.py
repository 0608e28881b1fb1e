"""Files from strangers as text or triangles: bounded in size and depth, own errors only."""

from irb2400_ctrl.reading.bounded_text import bounded_text, toml_tables
from irb2400_ctrl.reading.looks_like import looks_like
from irb2400_ctrl.reading.lvm_blocks import lvm_blocks
from irb2400_ctrl.reading.sheet_blocks import sheet_blocks
from irb2400_ctrl.reading.stand_in import refuse_stand_in
from irb2400_ctrl.reading.text_blocks import text_blocks
from irb2400_ctrl.reading.triangles import triangles_of
from irb2400_ctrl.reading.xml_root import xml_root

__all__ = [
    "bounded_text",
    "looks_like",
    "lvm_blocks",
    "refuse_stand_in",
    "sheet_blocks",
    "text_blocks",
    "toml_tables",
    "triangles_of",
    "xml_root",
]
