"""What follows from the outcomes of runs, and how sure it is: mathematics only.

What is counted of each run is listed in `../quantities.py`.
"""
