"""Plans under edit: revisions, commands, undo and redo. Pure: no disk, no clock, no web."""
