"""Tests of the guard: of a sample alone, and of motion against torque."""
