"""What the rest of the compiler builds on: data, errors, and small functions of no domain."""
