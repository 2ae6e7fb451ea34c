"""Jobs in separate processes, which end with the service."""
