"""The runs of the service's robot: one at a time, each in a process of its own."""
