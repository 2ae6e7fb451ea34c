"""The planning service: missions that many people edit at once, and the runs of one robot.

`core` is pure: what a plan is, and what commands make of it. `storage` keeps plans on disk. `web`
is a thin layer of HTTP and WebSockets.
"""
