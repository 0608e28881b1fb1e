"""What every effect would show on a log."""
