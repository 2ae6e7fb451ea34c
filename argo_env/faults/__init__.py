"""Faults of runs, each with a time, a place and a seed, and the parts of a run that they change."""
