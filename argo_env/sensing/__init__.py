"""Sensors that read checkpoints, and watches that detect what happens to the robot and the site."""
