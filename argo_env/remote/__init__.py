"""A robot that is somewhere else, told what to do and heard over a link."""
