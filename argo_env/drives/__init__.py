"""Drives, which move the robot, with their timetable, battery and powertrain."""
