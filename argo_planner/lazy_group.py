"""A group of commands whose modules are imported when one of them is called."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from itertools import pairwise
from typing import Any, ClassVar

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command

from argo_compiler.base.errors import Invalid
from argo_compiler.base.garbage_collector import collector_held
from argo_planner.terminal.verbosity import common_options


class _Command(TyperCommand):
    """Says what is wrong with an option in the words of the messages about files."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """The arguments that are left; raises UsageError."""
        for word in (argument.partition("=")[0] for argument in args):
            # It would be read as letters of their own: -report as -r -e -p ...
            if word[:2] != "--" and any(f"-{word}" in option.opts for option in self.params):
                raise Invalid(f"no option {word}; is -{word} meant?")
        try:
            return super().parse_args(ctx, args)
        except typer.BadParameter as error:
            from pydantic import ValidationError

            from argo_env.files.yaml_messages import error_message

            if isinstance(error.__cause__, ValidationError):
                error.message = error_message(error.__cause__.errors(include_url=False)[0], ())
            raise


@dataclass(frozen=True)
class LazyCommand:
    """A command by its name, where its function is found, and the line that lists it."""

    name: str
    module: str
    function: str
    help: str


class LazyGroup(TyperGroup):
    """Lists its commands without importing them, in the order of `lazy_commands`."""

    lazy_commands: ClassVar[Sequence[LazyCommand]] = ()

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        for command in self.lazy_commands:
            self.add_command(TyperCommand(command.name, help=command.help))

    # What runs, helps or completes a command comes by here; what lists them does not.
    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command that is called, with its parameters."""
        if not ctx.resilient_parsing and any(
            f"--{args[0]}" in option.opts for option in self.get_params(ctx)
        ):
            raise Invalid(f"no command {args[0]}; is --{args[0]} meant?")
        name, listed, rest = super().resolve_command(ctx, args)
        if not ctx.resilient_parsing:
            _require_said(rest)
        called = next((c for c in self.lazy_commands if c.name == name), None)
        return name, load_command(called) if called else listed, rest


def _require_said(arguments: Sequence[str]) -> None:
    """Raises Invalid where one is empty, as in `--report "$UNSET"`: what is named so would be the
    current folder."""
    for before, argument in pairwise(("", *arguments)):
        option, equals, value = argument.partition("=")
        if not argument:
            option = before
        elif not (equals and option.startswith("--") and not value):
            continue
        place = f"{option}: its value" if option.startswith("-") else "an argument"
        raise Invalid(f"{place} is empty; say what is meant, or leave it out")


def load_command(command: LazyCommand) -> Any:
    """The command with its parameters, as Typer makes it of its function."""
    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    # What is imported stays: to look for garbage in it takes a tenth of a short command's time.
    with collector_held():
        module = import_module(command.module)
    app.command(command.name, cls=_Command)(getattr(module, command.function))
    loaded = get_command(app)
    loaded.params += _common_parameters()
    return loaded


def _common_parameters() -> list[Any]:
    """Those of the options that all commands have."""
    app = typer.Typer(add_completion=False)
    app.command()(common_options)
    return [parameter for parameter in get_command(app).params if parameter.name != "help"]
