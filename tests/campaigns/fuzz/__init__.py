"""Inputs made at random, and what becomes of them."""
