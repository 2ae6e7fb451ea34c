"""Robot: its dimensions, its model and its pose; `argo_env/drives` moves it."""
