"""The planning language: IL, script front end, diagnostics, state machine and executor."""
