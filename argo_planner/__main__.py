"""`python -m argo_planner` is the command `argo`."""

from argo_planner.entry import main

main()
