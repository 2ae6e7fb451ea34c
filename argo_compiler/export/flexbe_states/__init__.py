"""The FlexBE states that missions exported by Argo are made of.

The robot's side calls `connect` (in `robot.py`) before a behaviour is run.
"""
