"""Recordings: a run as an .mcap file that Foxglove opens and `argo replay` reads back."""
