"""Simple rules to visit checkpoints by: what everything else has to beat."""
