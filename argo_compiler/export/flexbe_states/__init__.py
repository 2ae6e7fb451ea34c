"""FlexBE states of the missions that Argo exports.

The robot's side must call `connect` (in `robot.py`) before a behaviour runs.
"""
