"""Sensing: how values are read from checkpoints."""
