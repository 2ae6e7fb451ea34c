"""The robot: its measures and the drives that move it."""
