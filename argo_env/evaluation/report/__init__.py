"""The reports of evaluations and of comparisons: pages that need no other file."""
