"""Foundations of the compiler: base classes of data, errors, and small functions of no domain."""
