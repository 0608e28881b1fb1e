"""A third plant that shares no code with the library, nor its laws, motions and dynamics with the
other two plants: blind test logs with a known truth, as printed digits."""
