"""The text of a script: how it is read from a file or a document, and where its parts stand."""
