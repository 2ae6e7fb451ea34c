"""The planning service over HTTP and WebSockets: a thin layer, safe by default."""
