"""Where the flippers are on the way, and how fast they turn, for every drive."""

import math

RAISED = math.radians(30.0)
"""rad, tips up: on the flat"""
FLAT = 0.0
"""rad: on a flight"""
RATE = math.radians(110.0)
"""rad/s (public model files of the taurob tracker)"""
