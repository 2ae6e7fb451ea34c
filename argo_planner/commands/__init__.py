"""The commands of `argo`, one per file; `argo_planner.cli` gives them their names."""
