"""Conversion of a mission to its route problem, and of a route to the reordered mission.

A unit is here a task with all that may be done before the next unit, or a group (see `units`); the
problem has one visit for each unit of the first kind. A unit of time is one of the travel matrix.
"""
