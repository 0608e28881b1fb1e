"""How well names are given on arms that nobody tuned to: suites of the second plant, two givers."""
