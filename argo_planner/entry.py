"""The entry point of the command `argo`, which can be interrupted at any moment."""

import gc
import os


def main() -> None:
    """Prepare for signals, import the command line and run it.

    Signals come first, as the imports take most of a second.
    """
    try:
        from argo_planner.terminal.signals import exit_on_signals

        exit_on_signals()
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    gc.disable()  # imported modules stay in memory; a command calls `enable_garbage_collector`
    # To find plug-ins, pydantic would read the metadata of every installed package.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    from argo_planner import cli

    cli.main()
