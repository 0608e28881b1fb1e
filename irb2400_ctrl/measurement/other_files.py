"""Files that hold recordings and are not read: what to make of them."""

from __future__ import annotations

import re
from codecs import BOM_UTF8
from pathlib import Path

from irb2400_ctrl.errors import InputError

SHEET = "a spreadsheet of another kind: save the sheet with the samples as .xlsx or CSV"
PICKLE = "a pickle, which may run any code when it is opened: save its table as CSV or Parquet"
ARCHIVE = "an archive: unpack it and save its log (.csv, or .csv.gz)"
ADVICE = {
    **dict.fromkeys((".xls", ".xlsb", ".ods"), SHEET),
    **dict.fromkeys((".pkl", ".pickle", ".joblib"), PICKLE),
    ".npy": "one array without names: save time_s, q_rad, tau_Nm with np.savez as an .npz",
    ".json": "JSON: write a CSV with a row per sample",
    ".jsonl": "JSON: write a CSV with a row per sample",
    ".xml": "XML: write a CSV with a row per sample",
    ".bag": "a bag of ROS 1: convert it (rosbags-convert) or write a topic as text (rostopic "
    "echo -b FILE -p /joint_states > log.csv)",
    ".r64": "binary samples of a KUKA trace: export them as text with the controller's trace tool",
    ".tdms": "a binary file of LabVIEW: export it as .lvm or CSV",
    **dict.fromkeys((".zip", ".7z", ".rar", ".tar", ".bz2", ".xz", ".zst"), ARCHIVE),
    ".feather": "a Feather file: save it as Parquet",
}
"""by suffix, what the file is and what reads instead"""


TRACE = b"DIAEXTENDED"
"""what the `.dat` of a KUKA trace begins with: a header of DIAdem, its samples are in a `.r64`"""
_BEGINNINGS = (
    (re.compile(rb'\s*\{\s*"'), ADVICE[".json"]),
    (re.compile(rb"\s*<(\?xml|(\w+)[ >].*?</)", re.DOTALL), ADVICE[".xml"]),
)
"""how a file begins that is another thing than its suffix says"""


def refuse_other_files(path: Path) -> None:
    """Refuse what is known not to be read.

    Raises:
        InputError: such a file; says what to do.
    """
    advice = ADVICE.get(path.suffix.lower())
    if path.is_file() and advice is None:
        with path.open("rb") as file:
            begin = file.read(1000).removeprefix(BOM_UTF8)
        advice = next((told for form, told in _BEGINNINGS if form.match(begin)), None)
        if begin.startswith(TRACE):
            advice = f"the header of a KUKA trace; beside it are {ADVICE['.r64']}"
    if advice is not None:
        raise InputError(
            f"{path}: found {advice}; expected .csv, .xlsx, .lvm, .parquet, .mat, .npz, .h5 or a "
            "bag"
        )
