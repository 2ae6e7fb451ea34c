"""Evaluations of missions: starting, storing and resuming them, and replaying their runs."""
