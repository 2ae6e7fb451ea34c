"""Pool of worker processes, here or on a cluster, that survives the death of workers."""
