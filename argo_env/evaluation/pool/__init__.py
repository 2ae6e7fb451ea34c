"""Many calls of a function in worker processes, here or on a cluster, of which some may die."""
