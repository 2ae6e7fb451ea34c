"""The planning language: IL, script front end, diagnostics, state machine and executor."""

__version__ = "0.1.0"
