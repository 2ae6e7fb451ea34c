"""What follows from the outcomes of runs, and how sure it is."""
