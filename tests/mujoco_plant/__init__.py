"""A second plant that shares no code with the library: MuJoCo's arm, with laws drawn per arm."""
