"""A script read piece by piece: text to syntax tree."""
