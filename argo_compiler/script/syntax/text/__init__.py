"""The text of a script: where its parts stand, and what text recognition did to it."""
