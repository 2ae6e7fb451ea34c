"""Random inputs of the compiler, and the laws that their results must satisfy."""
