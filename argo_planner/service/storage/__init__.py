"""Mission plans on disk; acknowledged changes survive a process that is killed."""
