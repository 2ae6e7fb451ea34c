"""Drafts of uploaded scripts: what is left to decide, and what people have decided."""
