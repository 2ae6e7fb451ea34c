"""Foundations of the compiler: base classes of data, errors, and general helper functions."""
