"""Reading checkpoints from the images of the camera on the arm."""
