"""Files: the data that Argo ships, YAML read with errors in place, folders for results."""
