"""Statistical estimates from the outcomes of runs, with confidence intervals and tests.

The counted quantities are listed in `../quantities.py`.
"""
