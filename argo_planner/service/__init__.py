"""Planning service: missions that several people edit together, and the runs of one robot.

`core` defines mission plans and the effects of commands, without side effects. `storage` stores
plans on disk. `web` is a thin layer of HTTP and WebSockets.
"""
