"""The parts that drawn plans of sites are made of: floors, ways, marks, legends."""
