"""How, when and how often something is done."""

from argo_compiler.base.records import dataclass
from argo_compiler.il import Afterwards, JointState, Order
from argo_compiler.script.sentences.tree.conditions import Amount, SaidCondition
from argo_compiler.script.sentences.tree.nouns import Nouns
from argo_compiler.script.sentences.tree.places import Coordinates, FloorName, Steps


@dataclass(slots=True, kw_only=True, unsafe_hash=True)
class Manner:
    """How, when and how often an order is carried out; false without any of these. Not frozen, as
    very many are made, and a frozen one takes longer to make; nothing changes one."""

    speed: float | None = None
    """m/s on the way to each task"""
    leaving: float | None = None
    """m/s on the way to the task after"""
    delay: float | None = None
    """s to wait before it"""
    time_limit: float | None = None
    """s"""
    mission_time: float | None = None
    """s, of the whole mission"""
    reading_limit: float | None = None
    """s"""
    optional: bool = False
    priority: int | None = None
    rank: int | None = None
    """a priority in words"""
    by_importance: bool = False
    """whether each of the tasks is worth more than those behind it"""
    earliest: float | None = None
    """s after the mission's start"""
    latest: float | None = None
    """s after the mission's start"""
    soft_window: bool = False
    times: int | None = None
    """rounds in all"""
    more: bool | None = None
    """whether the rounds are further ones (`again`), or all of them (`in total`)"""
    at_most: int | None = None
    """rounds, with `until`"""
    every: float | None = None
    """s from the beginning of a round to that of the next"""
    pause: float | None = None
    """s between one round and the next"""
    duration: float | None = None
    """s"""
    until: SaidCondition | None = None
    finishing: bool | None = None
    """whether the round is completed when the time is up"""
    count_interruptions: bool = False
    endless: bool = False
    in_circles: bool = False
    floors: tuple[FloorName, ...] = ()
    """where all that is measured is: `on the second floor, check the valve`"""
    backwards: bool = False
    """whether what is measured is measured from the last to the first"""
    task_pair: Nouns | Steps | None = None
    """the neighbouring tasks between which it is done"""
    order: Order | None = None
    """whether the tasks may change places"""
    condition: SaidCondition | None = None
    """`check #8 if it is above 5`"""
    joints: JointState | None = None
    shown_in: str | None = None
    object_id: str | None = None
    pose: Coordinates | None = None
    person: bool = False
    """`for the operator`"""
    on_limit: Afterwards | None = None
    """of a reaction's hold"""
    charge: Amount | None = None
    """charge of the battery: `to 80 %`"""
    charge_time: float | None = None
    """s for which the battery is charged at least"""

    def __bool__(self) -> bool:
        return self is not NOTHING_SAID and self != NOTHING_SAID


NOTHING_SAID = Manner()
