"""`python -m irb2400_ctrl`: the command line where the script `irb2400` is not on the path."""

from __future__ import annotations

from irb2400_ctrl.cli.main import run

if __name__ == "__main__":
    run()
