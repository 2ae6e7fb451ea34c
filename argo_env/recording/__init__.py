"""Recordings: a run in an .mcap file, which Foxglove opens and a replay reads back."""
