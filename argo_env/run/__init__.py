"""Running a mission: the simulation, what it is made with, its log, journal and record."""
