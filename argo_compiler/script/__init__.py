"""The script front end: text as people write it becomes a mission."""
