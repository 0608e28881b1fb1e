"""Time laws without a jump of torque or acceleration."""
