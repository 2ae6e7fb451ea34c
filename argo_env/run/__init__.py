"""Runs of missions: simulation, run setup, state, log, journal, observers and record."""
