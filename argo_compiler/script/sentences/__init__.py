"""Words, grammar and tree of single sentences."""
