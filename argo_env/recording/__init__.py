"""Recordings: a run as an .mcap file that Foxglove opens and a replay reads back."""
