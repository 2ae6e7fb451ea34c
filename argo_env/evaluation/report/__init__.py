"""Reports of evaluations and of comparisons: HTML pages that need no other file."""
