"""What the columns of a log show of themselves, without any robot."""
