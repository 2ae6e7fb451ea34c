"""A learned policy for `argo/Route-v0`: MaskablePPO with attention over the checkpoints."""
