"""Parts of drawn plans of sites: floors, paths, marks and legends."""
