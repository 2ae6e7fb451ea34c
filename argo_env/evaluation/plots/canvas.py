"""Axes to draw on, their colours and marks, and names that are safe to be drawn."""

from typing import TYPE_CHECKING

from argo_env.report.svg import clean, shorten

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK, SOFT, LINE, PAPER = "#1c2733", "#5b6b7c", "#dde3ea", "#fffffe"
GOOD, BAD, WARN = "#15803d", "#c81e1e", "#b45309"
SERIES = (
    "#1d4ed8", "#c2410c", "#0f766e", "#7c3aed", "#a16207", "#be185d", "#334155", "#4d7c0f",
)  # fmt: skip
"""the colours of plans, one after the other"""
MARKS = ("o", "s", "^", "D", "v", "P", "X")
"""the marks of plans: they differ without colours too, and less often are the same as these"""
GROUND, DECK, STAIR, STRUCTURE, EDGE = "#f1f3f5", "#e3e8ed", "#c9d2da", "#aab6c1", "#9aa7b3"
"""what a site is made of"""

WIDTH = 4.6  # inches, of a figure that can be read on a phone
FONT = 9.0  # points; smaller ones are for what can be read elsewhere as well


def axes(ax: "Axes | None", height: float = 3.0, width: float = WIDTH) -> "Axes":
    """The axes that are given, or those of a new figure of that size (inches), which pyplot knows
    nothing of: `axes.figure` shows it in a notebook."""
    if ax is None:
        from matplotlib.figure import Figure

        ax = Figure(figsize=(width, height), layout="constrained").subplots()
    ax.patch.set_visible(False)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        ax.spines[side].set_color(SOFT)
    ax.tick_params(colors=SOFT, labelsize=FONT)
    return ax


def rows_of(ax: "Axes", names: list[str]) -> None:
    """Gives the axes a row for each name, from above."""
    ax.set_yticks(range(len(names)), [plain(name) for name in names], color=INK)
    ax.set_ylim(max(len(names), 1) - 0.5, -0.5)
    ax.spines["left"].set_visible(False)
    ax.tick_params(axis="y", length=0, pad=7)


def beside(ax: "Axes", y: float, text: str, colour: str = SOFT) -> None:
    """A word at the right of the axes, at the height of a row."""
    ax.annotate(
        text, (1.02, y), xycoords=("axes fraction", "data"), ha="left", va="center",
        color=colour, fontsize=FONT - 1, annotation_clip=False,
    )  # fmt: skip


def nothing(ax: "Axes", why: str) -> "Axes":
    """Axes that say why there is nothing in them."""
    ax.set_axis_off()
    ax.text(0.5, 0.5, why, transform=ax.transAxes, ha="center", color=SOFT, fontsize=FONT)
    return ax


def mark(number: int) -> tuple[str, str]:
    """The colour and the mark of a plan, by its number."""
    return SERIES[number % len(SERIES)], MARKS[number % len(MARKS)]


def plain(name: str, room: float = 1.65) -> str:
    """A name that fits into so much room (inches) beside axes: one line, in which nothing is taken
    for a formula, or for a name that legends leave out."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

    font = FontProperties(size=FONT)
    name = shorten(" ".join(clean(name).split()), 80)
    while len(name) > 1 and (
        TextToPath().get_text_width_height_descent(name, font, False)[0] > 72.0 * room
    ):
        name = shorten(name, len(name) - 1)
    name = name.replace("$", r"\$")
    return f" {name}" if name.startswith("_") else name
