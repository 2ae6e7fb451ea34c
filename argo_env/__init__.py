"""The site: scenarios, geometry, navigation, robot, sensing, the mission runner and its reports."""
