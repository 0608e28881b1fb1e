"""Programs for the robot's own controller."""
