"""Drawings of plans: where the robot of an environment was, and what it still has to see."""
