"""A site as a page shows it: what is where, meshes, where the robot can stand, and ways."""
