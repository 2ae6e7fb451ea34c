"""Input and output on the terminal: options, files, tables, progress, messages."""
