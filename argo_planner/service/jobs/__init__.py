"""Long computations in separate processes: analyses, searches for orders, and evaluations."""
