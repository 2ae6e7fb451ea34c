"""Proposals: what a line may mean that the grammar does not take as it is."""
