"""What stands around sentences in English."""

from argo_compiler.il import Mode, Order
from argo_compiler.script.syntax.words.prose import Prose

LABELS = {
    "designation": "designation|mission designation|mission's designation|name of the mission",
    "mode": "mode|main mode|mission mode",
    "max_duration": (
        "maximum {mission} {total} {mission} duration|max {mission} {total} {mission} duration|"
        "max. {mission} {total} {mission} duration|maximum {mission} time|max {mission} time|"
        "max. {mission} time|time limit|duration|maximum length"
    ),
    "order": "order|order of the checkpoints|sequence",
    "anomaly_specification": "anomaly specification",
    "real_time_reporting": "real-time reporting|real time reporting",
    "after_mission_report": (
        "after-mission report|after mission report|after-mission reporting|after mission reporting"
    ),
    "initial_position": "initial position|start position|starting position|starting point|start",
    "end_of_mission": "end of the mission|end of mission|end|finish|end position|final position",
    "site": "site|plant",
    "start_area": "start area|starting area",
    "end_area": "end area",
    "dock": "dock",
    "current": "current",
    "left_out": "left out",
    "steps": (
        "checkpoints|checkpoints to read|checkpoints to check|checkpoints to inspect|"
        "checkpoints to visit|steps|tasks"
    ),
    "nothing": "from|cc|subject|date|author|written by|prepared by|operator|version|revision",
}

PROSE = Prose(
    labels=LABELS,
    values={
        ("order", Order.ANY): "any|any order|in any order|free|free order|any order will do",
        ("order", Order.PRECISE): (
            "precise|precise order|in this order|this precise order|in this precise order|as given|"
            "as listed|as written|fixed|in the given order"
        ),
        ("mode", Mode.AUTONOMOUS): "autonomous|autonomous mode|autonomously",
        ("mode", Mode.SUPERVISORY): "supervisory|supervisory mode|supervised",
        ("none", None): "none|no|no limit|unlimited|without limit|nowhere|-",
        ("as planned", None): "as planned",
    },
    around_areas=(
        "the|a|an|robot|is|to|be|docked|connected|and|in|into|at|from|of|on|its|it|docking|station|"
        "dock|mission|ends|end|when|parked|standing|stands|starts|start|returns|back|either|there|"
        "before|begins|begin|over|as|soon|charging|charged|placed|waiting|waits|will|has|returned|"
        "finished|finishes|after|initially|finally|position|then|this|that|their"
    ),
    columns={
        "number": "no|nr|number|step|#|item|pos",
        "checkpoint": "checkpoint|check point|checkpoint number|checkpoint no|id|point|cp|cp no",
        "object": "reading|object|name|gauge|instrument|what|device|valve|tag|equipment",
        "action": "action|task|order|activity|to do|instruction",
        "priority": "priority|importance|prio",
        "optional": "optional",
        "speed": "speed",
        "remark": "remark|remarks|comment|comments|note|notes|condition|conditions|how",
        "nothing": "floor|deck|location|done|ok|result",
    },
    ranks={"3": "high|very important|important", "2": "medium|normal|middle|mid", "1": "low"},
    yes="yes|y|x|true|optional",
    greeting="hello|hi|dear|hey|good morning|good afternoon|good evening|good day",
    closing=(
        "best|best regards|kind regards|warm regards|many thanks|best wishes|regards|thanks|"
        "thank you|thx|cheers|"
        "yours|sincerely|sincerely yours|see you|have a nice day|have a good day|"
        "have a nice weekend"
    ),
    remark=(
        "hint|hints|note|notes|remark|remarks|please note|nb|n.b.|comment|comments|info|fyi|"
        "background|reason|by the way"
    ),
    small_talk=(
        "i hope|we hope|hope|let me know|let us know|as discussed|as agreed|here is|here are|"
        "please find|attached|looking forward|if you have any questions|if there are any questions|"
        "call me if|below is|below are|see below|this is the|these are the|sorry for|many thanks|"
        "thank you|thanks|thx|bye|good luck|have fun|cheers|that's it|"
        "that is it"
    ),
    reason="because|which|who|since it|since the|as it|so that|in order to|for the",
    occasion="for|during|as part of|on the occasion of|in preparation for|with regard to",
    section=(
        "changes|change|tasks|task|steps|plan|round|tour|part|section|mission|orders|instructions|"
        "programme|program|inspection|schedule|route|list|addition|additions|update|updates|todo"
    ),
    listing="{the} following|these|those",
    counted="run|test|round|tour|patrol|drive|survey|measurement",
    preposition=(
        "of|at|in|on|for|to|from|with|by|after|before|during|and|or|near|around|over|under|through|"
        "between|per|about|without|within|along|behind|beside|next|is|are|was|were|it's|that's|"
        "there's|be"
    ),
    determiner="the|a|an|all|every|each|any|my|your|our|his|her|its|this|that|these|those|it|them|"
    "everything",
    explicit_title="mission protocol|mission sheet|mission order|mission",
    left_open=(
        "{the} dock{s} {is} {are} {will be} {to be} chosen|"
        "{the} docking station{s} {is} {are} {will be} {to be} chosen|"
        "{the} starting area{s} {is} {are} {will be} {to be} chosen|"
        "{the} start and {the} end {are} {will be} {to be} chosen"
    ),
    sheet=(
        "default|normal|values|position|positions|level|levels|checkpoints|specified|rules|rule|"
        "appendix|anomaly|anomalies|preparation|parameters|staff|during|before|site|report|"
        "reported|reporting|reading|readings|list|once|soon|found|noticed|more|whole|outside|"
        "range|states|catalogue|order|precise|area|areas|as|mission"
    ),
    no="no|n|-|false|must|required|mandatory",
    say={
        "checkpoint": "checkpoint",
        "priority": "with priority",
        "optional": "if there is time",
        "speed": "at",
    },
    samples={
        "MEASURE": "check checkpoint 4",
        "KEEP_MEASURING": "keep reading checkpoint 4 until the value is below 3",
        "GO": "go to starting area 2",
        "HOME": "return to the docking station in starting area 1",
        "START": "start in starting area 1",
        "PATROL": "patrol the second floor for 10 minutes",
        "WAIT": "wait 90 s",
        "PAUSE": "if a gas leak is detected, pause",
        "REPEAT": "repeat steps 2 to 4 three times",
        "ADD": "add checkpoint 4 after checkpoint 2",
        "DELETE": "delete checkpoint 4",
        "REPLACE": "replace checkpoint 4 by checkpoint 5",
        "MOVE": "move checkpoint 4 before checkpoint 2",
        "JUMP": "skip to step 5",
        "RETRY": "check checkpoint 4, retry twice",
        "IF": "if the value is above 5, check checkpoint 4",
        "UNLESS": "check checkpoint 4 unless checkpoint 2 is abnormal",
        "ELSE": "if the value is above 5, go on, otherwise check checkpoint 4",
    },
    kinds={
        "NUMBER": "a number",
        "IDENT": "a name such as `R25`",
        "PLACE": "a place of the site",
        "DURATION": "a time such as `10 min`",
        "QUANTITY": "a value such as `4.5 bar`",
        "SPEED": "a speed such as `0.3 m/s`",
        "TIMES": "how often, such as `three times`",
        "EVENT": "an event such as `a gas leak`",
    },
    untold=frozenset(
        [
            "STRING",
            "LPAR_CALLED",
            "LPAR_BOUND",
            "SECOND_BOUND",
            "JOINTS",
            "STANDING",
            "SHOWN_IN",
            "ABOUT",
            "LEAVING",
            "JOINT",
            "X",
            "Y",
            "Z",
            "RAD",
            "MODE",
            "VALUE",
            "FINISHING",
            "STOPPING",
            "INCLUDED",
            "EXCLUDED",
            "ENDLESS",
            "IN_CIRCLES",
        ]
    ),
)
