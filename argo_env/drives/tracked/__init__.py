"""Tracked robot with masses, forces and belts, and the drive that follows paths with it."""
