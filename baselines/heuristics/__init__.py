"""Heuristics that choose routes: the standard of comparison for all other policies."""
