"""The text of a script: how it is read from a file, where its parts stand, what noise it has."""
