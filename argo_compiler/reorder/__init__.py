"""Conversion of a mission to its route problem, and of a route to the reordered mission."""
