"""Learning curve of a training: `python -m baselines.learned.curve DIR PICTURE` draws it."""

import argparse
import sys
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from argo_compiler.base.errors import ArgoError, Invalid, NotFound
from baselines.learned.extra import require_learned_extra

Points = list[tuple[int, float]]
"""pairs of the number of states learned from so far, and a value"""

_SETS = {
    "random-20": "20 checkpoints, random sites",
    "random-40": "40 checkpoints, random sites",
    "mixed-40": "20 to 40 checkpoints, many kinds of sites",
}


def read_points_by_tag(folder: Path) -> dict[str, Points]:
    """Return the values in the TensorBoard logs of a training, by tag.

    Raises ArgoError if there are no logs, or no part of the training is completed.
    """
    require_learned_extra()
    from tensorboard.backend.event_processing.event_accumulator import (  # type: ignore[import-untyped]
        EventAccumulator,
    )

    if not (folder / "logs").is_dir():
        raise NotFound(f"no logs of a training: the folder {folder / 'logs'} does not exist")
    logs = EventAccumulator(str(folder / "logs"), size_guidance={"scalars": 0})
    logs.Reload()
    tags = logs.Tags()["scalars"]
    if not any(tag.startswith("validation/") for tag in tags):
        raise Invalid(
            f"{folder / 'logs'} has no completed part of a training: wait for the first part"
        )
    return {tag: [(event.step, event.value) for event in logs.Scalars(tag)] for tag in tags}


def draw_curve(logs: dict[str, Points], picture: Path) -> None:
    """Plot the mean prizes on the validation sets, in the lessons and in MaskablePPO."""
    figure, axes = plt.subplots(1, len(_SETS), figsize=(12, 3.6), layout="constrained")
    lessons = [step for step, _ in logs.get("lessons/actions", [])]
    for panel, (name, title) in zip(axes, _SETS.items(), strict=True):
        _draw_set(panel, logs[f"validation/{name}"], max(lessons, default=0))
        panel.set_title(title, fontsize=10)
    axes[0].set_ylabel("mean prize, best node each time")
    figure.savefig(picture, dpi=110)
    plt.close(figure)


def _draw_set(panel: Axes, points: Points, lessons: int) -> None:
    """Plot one validation set; `lessons` is the number of states learned from in lessons."""
    steps = [step / 1e6 for step, _ in points]
    prizes = [prize for _, prize in points]
    panel.axvspan(0, lessons / 1e6, color="#e8eef4", label="lessons")
    panel.axvspan(lessons / 1e6, steps[-1], color="#fdf3e3", label="MaskablePPO")
    panel.plot(steps, prizes, "o-", markersize=3, color="#1f5f99", label="validation")
    panel.set_xlim(0, steps[-1])
    panel.set_xlabel("million states learned from")
    panel.grid(alpha=0.3)
    panel.legend(loc="lower right", fontsize=8)


def main(arguments: list[str] | None = None) -> int:
    """Run the command; return its exit status, 2 after an error that is reported."""
    parser = argparse.ArgumentParser(prog="python -m baselines.learned.curve", description=__doc__)
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of the training (--out)")
    parser.add_argument("picture", type=Path, metavar="PICTURE", help="a .png or .svg to write")
    options = parser.parse_args(arguments)
    try:
        draw_curve(read_points_by_tag(options.folder), options.picture)
    except ArgoError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
