"""Open mission plans: each change is written to disk and then sent to all members."""
