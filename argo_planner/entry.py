"""The way into the command `argo`, which may be interrupted from its first moment on."""


def main() -> None:
    """Makes ready for signals before anything else is imported, which takes most of a second."""
    try:
        from argo_planner.terminal.signals import end_at_once

        end_at_once()
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    from argo_planner import cli

    cli.main()
