"""The commands of `argo`, a file each. `argo_planner.cli` gives them their names."""
