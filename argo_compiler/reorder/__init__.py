"""From a mission to its route problem, and back to the mission in another order."""
