"""What moves the robot: the drives, their timetable, battery and powertrain."""
