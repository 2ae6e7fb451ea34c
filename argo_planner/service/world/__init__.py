"""A site for a page: its description, meshes, maps of where the robot can stand, and paths."""
