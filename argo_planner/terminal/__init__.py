"""What a person gives and sees on the terminal: options, files, tables, progress, messages."""
