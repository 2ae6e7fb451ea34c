"""The robot: its measures, its model and its pose. What moves it is in `argo_env/drives`."""
