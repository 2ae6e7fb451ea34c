"""A site for the planner page: description, meshes, maps of where the robot can stand, paths."""
