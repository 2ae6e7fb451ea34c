"""A group of commands whose modules are imported only when one of them is called."""

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
from argo_planner.terminal.verbosity import declare_common_options


class _Command(TyperCommand):
    """A command that reports a wrong option in the words of the messages about files."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the options and return the remaining arguments.

        Raises:
            Invalid: a long option has only one dash.
            UsageError: Click finds another error.
        """
        for word in (argument.partition("=")[0] for argument in args):
            # Click would read each letter as an option: -report as -r -e -p ...
            if word[:2] != "--" and any(f"-{word}" in option.opts for option in self.params):
                raise Invalid(f"there is no option {word}; did you mean -{word}?")
        try:
            return super().parse_args(ctx, self._with_joined_values(args))
        except typer.BadParameter as error:
            from pydantic import ValidationError

            from argo_env.files.yaml_messages import error_message

            if isinstance(error.__cause__, ValidationError):
                error.message = error_message(error.__cause__.errors(include_url=False)[0], ())
            raise

    def _with_joined_values(self, args: Sequence[str]) -> list[str]:
        """Return the arguments with the two words of `--say LINE TEXT` in one.

        The library lets no option with two words be given more than once.
        """
        double = {opt for option in self.params if _has_two_words(option) for opt in option.opts}
        joined: list[str] = []
        rest = list(args)
        while rest:
            joined.append(rest.pop(0))
            if joined[-1] in double and len(rest) > 1:
                joined.append(f"{rest.pop(0)} {rest.pop(0)}")
        return joined


def _has_two_words(option: Any) -> bool:
    several = getattr(option, "multiple", False) and option.nargs == 1
    return several and " " in (option.metavar or "")


@dataclass(frozen=True)
class LazyCommand:
    """A command's name, its module and function, and its line in the list of commands."""

    name: str
    module: str
    function: str
    help: str


class LazyGroup(TyperGroup):
    """Group of commands that lists them without importing them, in the order of `lazy_commands`."""

    lazy_commands: ClassVar[Sequence[LazyCommand]] = ()

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        for command in self.lazy_commands:
            self.add_command(TyperCommand(command.name, help=command.help))

    # Click calls this to run a command, show its help or complete it, but not to list commands.
    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the name of the called command, the command itself, and its arguments."""
        if not ctx.resilient_parsing and any(
            f"--{args[0]}" in option.opts for option in self.get_params(ctx)
        ):
            raise Invalid(f"there is no command {args[0]}; did you mean --{args[0]}?")
        name, listed, rest = super().resolve_command(ctx, args)
        if not ctx.resilient_parsing:
            _require_no_empty(rest)
        called = next((c for c in self.lazy_commands if c.name == name), None)
        return name, load_command(called) if called else listed, rest


def _require_no_empty(arguments: Sequence[str]) -> None:
    """Raise Invalid if an argument or the value of an option is empty.

    Such as `--report "$UNSET"`: as a path, the empty text would be the current folder.
    """
    for before, argument in pairwise(("", *arguments)):
        option, equals, value = argument.partition("=")
        if not argument:
            option = before
        elif not (equals and option.startswith("--") and not value):
            continue
        place = f"{option}: its value" if option.startswith("-") else "an argument"
        raise Invalid(f"{place} is empty; give a value, or leave it out")


def load_command(command: LazyCommand) -> Any:
    """Return the command with its parameters, which Typer makes from its function."""
    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    # Imported modules stay in memory; searching them for garbage takes a tenth of the time of a
    # short command.
    with collector_held():
        module = import_module(command.module)
    app.command(command.name, cls=_Command)(getattr(module, command.function))
    loaded = get_command(app)
    loaded.params += _common_parameters()
    return loaded


def _common_parameters() -> list[Any]:
    """Return the parameters of the options that all commands have."""
    app = typer.Typer(add_completion=False)
    app.command()(declare_common_options)
    return [parameter for parameter in get_command(app).params if parameter.name != "help"]
