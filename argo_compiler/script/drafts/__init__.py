"""Drafts: a script line by line, with what each line becomes and what a person has decided."""
