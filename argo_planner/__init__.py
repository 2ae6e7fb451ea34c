"""The command `argo`, the planning service and the planner page."""
