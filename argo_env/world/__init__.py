"""Simulated worlds: one in PyBullet, and one without physics."""
