"""Mission plans: revisions, commands, undo and redo; without access to disk, clock or network."""
