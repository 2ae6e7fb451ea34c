"""Plans that are open: what somebody changes is on disk, then everybody who is there is told."""
