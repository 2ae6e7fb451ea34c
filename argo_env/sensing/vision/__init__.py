"""Camera sensor: it reads checkpoints from the pictures of the camera on the arm."""
