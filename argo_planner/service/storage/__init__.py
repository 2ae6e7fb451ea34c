"""Plans on disk: what was acknowledged survives a process that is killed."""
