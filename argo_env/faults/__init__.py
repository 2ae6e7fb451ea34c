"""What goes wrong during a run: faults with a time, a place and a seed, and what they act on."""
