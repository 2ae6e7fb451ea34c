"""Evaluations of missions over many simulated runs: success rates, failure causes, comparisons."""
