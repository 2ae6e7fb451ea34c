"""The planning service over HTTP and WebSockets: a thin layer with strict access rules."""
