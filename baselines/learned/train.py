"""`python -m baselines.learned.train --out DIR` trains the policy; `--resume DIR` goes on."""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from argo_compiler.base.errors import ArgoError, Conflict, Invalid
from argo_compiler.base.stages import listen_to_stages
from argo_env.files.folders import make_folder
from baselines.learned.extra import check_learned
from baselines.stage_lines import StageLines


def main(arguments: list[str] | None = None) -> int:
    """The exit status: 2 if nothing could be trained."""
    parser = argparse.ArgumentParser(prog="python -m baselines.learned.train", description=__doc__)
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--out", type=Path, metavar="DIR", help="train from nothing, and write here")
    where.add_argument("--resume", type=Path, metavar="DIR", help="go on where that one stopped")
    parser.add_argument("--seed", type=_whole(0), help="default 0")
    parser.add_argument(
        "--lesson-parts", type=_whole(1), help="rounds of imitating exact values, first of all"
    )
    parser.add_argument("--parts", type=_whole(0), help="of MaskablePPO, after that")
    given = parser.parse_args(arguments)
    try:
        check_learned()
        _train(given)
    except ArgoError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def _train(given: argparse.Namespace) -> None:
    from baselines.learned.training import CHECKPOINT, Settings, begin, load, train

    chosen = {
        name: value
        for name in ("seed", "lesson_parts", "parts")
        if (value := getattr(given, name)) is not None
    }
    if given.resume:
        if chosen:
            raise Invalid("--resume goes on with the settings that the training began with")
        state, folder = load(given.resume), given.resume
    else:
        folder = given.out
        if (folder / CHECKPOINT).exists():
            raise Conflict(f"{folder} has a training already: --resume {folder}, or another --out")
        make_folder(folder)
        state = begin(replace(Settings(), **chosen))
    with listen_to_stages(StageLines(lambda line: print(line, file=sys.stderr, flush=True))):
        train(state, folder, lambda line: print(line, flush=True))


def _whole(least: int):  # type: ignore[no-untyped-def]
    def read(text: str) -> int:
        number = int(text)
        if not least <= number:
            raise argparse.ArgumentTypeError(f"it is at least {least}")
        return number

    return read


if __name__ == "__main__":
    sys.exit(main())
