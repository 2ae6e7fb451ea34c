"""The way into the command `argo`, which may be interrupted from its first moment on."""

import gc
import os


def main() -> None:
    """Makes ready for signals before anything else is imported, which takes most of a second."""
    try:
        from argo_planner.terminal.signals import end_at_once

        end_at_once()
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    gc.disable()  # what is imported stays; `collect_again` is called when a command begins
    # To look for plug-ins pydantic would read what every installed package says of itself.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    from argo_planner import cli

    cli.main()
