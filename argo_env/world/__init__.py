"""What the robot touches, sees and stands on: the PyBullet world, and the one on paper."""
