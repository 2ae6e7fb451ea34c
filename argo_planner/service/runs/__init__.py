"""Runs of the service's robot: one at a time, each in a separate process."""
