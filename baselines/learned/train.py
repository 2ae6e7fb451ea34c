"""Training of the learned policy: `--out DIR` starts a training, `--resume DIR` continues it."""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from argo_compiler.base.errors import ArgoError, Conflict, Invalid
from argo_compiler.base.stages import listen_to_stages
from argo_env.files.folders import make_folder
from baselines.learned.extra import require_learned_extra
from baselines.stage_lines import StageLines


def main(arguments: list[str] | None = None) -> int:
    """Run the command; return its exit status, 2 after an error that is reported."""
    parser = argparse.ArgumentParser(prog="python -m baselines.learned.train", description=__doc__)
    folder = parser.add_mutually_exclusive_group(required=True)
    folder.add_argument("--out", type=Path, metavar="DIR", help="folder of a new training")
    folder.add_argument("--resume", type=Path, metavar="DIR", help="folder of a training to resume")
    parser.add_argument("--seed", type=_integer_from(0), help="seed of a new training; default 0")
    parser.add_argument(
        "--lesson-parts",
        type=_integer_from(1),
        help="number of parts of the first stage, imitation of exact values",
    )
    parser.add_argument(
        "--parts", type=_integer_from(0), help="number of parts of the second stage, MaskablePPO"
    )
    options = parser.parse_args(arguments)
    try:
        require_learned_extra()
        _train(options)
    except ArgoError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def _train(options: argparse.Namespace) -> None:
    from baselines.learned.training import (
        CHECKPOINT,
        Settings,
        load_checkpoint,
        train,
        untrained_state,
    )

    chosen = {
        name: value
        for name in ("seed", "lesson_parts", "parts")
        if (value := getattr(options, name)) is not None
    }
    if options.resume:
        if chosen:
            raise Invalid(
                "--resume uses the settings that the training began with: leave out the other "
                "options"
            )
        state, folder = load_checkpoint(options.resume), options.resume
    else:
        folder = options.out
        if (folder / CHECKPOINT).exists():
            raise Conflict(
                f"{folder} already has a training: resume it with --resume {folder}, or choose "
                "another folder with --out"
            )
        make_folder(folder)
        state = untrained_state(replace(Settings(), **chosen))
    with listen_to_stages(StageLines(lambda line: print(line, file=sys.stderr, flush=True))):
        train(state, folder, lambda line: print(line, flush=True))


def _integer_from(minimum: int):  # type: ignore[no-untyped-def]
    """Return a type for argparse: an integer that is at least `minimum`."""

    def parse(text: str) -> int:
        number = int(text)
        if not minimum <= number:
            raise argparse.ArgumentTypeError(f"give a number of at least {minimum}")
        return number

    return parse


if __name__ == "__main__":
    sys.exit(main())
