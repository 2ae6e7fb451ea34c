"""From mission to text: the canonical script."""
