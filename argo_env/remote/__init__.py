"""Remote robot, which receives orders and sends reports over a link."""
