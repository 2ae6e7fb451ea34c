"""Estimates from the outcomes of runs, and how sure they are: mathematics only.

What is counted of each run is listed in `../statistics.py`.
"""
