"""Files: data that Argo ships, YAML parsing with error locations, disk cache, result folders."""
