"""Mission files: read with errors in place, brought up to date, and written whole."""
