"""The evaluations of missions: begun, kept on disk, gone on with, their runs replayed."""
