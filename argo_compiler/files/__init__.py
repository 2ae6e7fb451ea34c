"""Mission files and other files: loading with located errors, migration, and atomic writing."""
