"""The words of English. `check{s}` is two words, bars separate phrases."""

from argo_compiler.il import EventKind, Mode
from argo_compiler.script.syntax.tree.nouns import Kind
from argo_compiler.script.syntax.words.lexicon import Phrases, expand
from argo_compiler.script.syntax.words.numbers import Figure

NOTHING: Phrases = {
    ("FILLER", None): (
        "the|a|an|please|kindly|just|then|there|straight|directly|at once|immediately|right away|"
        "now|as well|too|also|could you please|could you|can you please|would you please|"
        "i would like you to|we need you to|have|let|make sure to|should|must|will|shall|has to|have to|will have to|"
        "is to|needs to|robot|it should|it has to|it must|it will|it shall|it is to|let it|have it|"
        "after that|afterwards|finally|first of all|at the end|in the end|next|subsequently|"
        "of them|of these|of those|after this|from there|so|when you are done|when done|when finished|general rule|where the robot stands|where it stands|send the robot out"
    ),
    ("IDLE", None): "today|tonight|tomorrow|this morning|this evening|carefully",
}

VERBS: Phrases = {
    ("MEASURE", None): (
        "check{s}|measure{s}|read{s}|inspect{s}|control{s}|verif{y}|verifies|examine{s}|look{s} at|"
        "have a look at|take a look at|take a reading of|record{s}|monitor{s}"
    ),
    ("KEEP_MEASURING", None): "keep{s} reading|keep{s} checking|keep{s} measuring",
    ("BE_MEASURED", None): (
        "has to be read|has to be checked|has to be measured|must be read|must be checked|"
        "must be measured|should be read|should be checked|should be measured|is read|is checked|"
        "is measured|are read|are checked|have to be read|have to be checked|is to be read|"
        "is to be checked"
    ),
    ("GO", None): (
        "go{es} {back} to|go{es} {back} into|drive{s} {back} to|drive{s} {back} into|"
        "return{s} to|move{s} to|head{s} {back} to|come{s} back to|get{s} back to|travel{s} to|"
        "proceed{s} to|back to|go{es}|drive{s}|it goes to"
    ),
    ("HOME", None): (
        "go{es} {back} home|drive{s} {back} home|come{s} {back} home|return{s} home|return{s}|go{es} back|drive{s} back|"
        "come{s} back|it goes home|return{s} to base|home"
    ),
    ("START", None): (
        "set start|set a starting point|set the starting point|set a start point|set the start point|"
        "start{s}|begin{s}|start{s} from|begin{s} from|leave{s}|leaves from|leave from|"
        "is waiting|is standing|stands|starts out"
    ),
    ("PATROL", None): "patrol{s}",
    ("WAIT", None): "wait{s}|stay{s}",
    ("FOR_PERSON", None): "for operator|for an operator|for a person|for somebody",
    ("PAUSE", None): "pause{s}|stop{s}|halt{s}|stand{s} still|hold{s}|stop{s} the round",
    ("END", None): (
        "end the mission|finish the mission|stop the mission|terminate the mission|end|"
        "that is the end of the mission|this is the end of the mission"
    ),
    ("ABORT", None): "abort|abort the mission|mission is aborted|cancel the mission",
    ("GO_ON", None): (
        "then go on|go{es} on|continue{s}|carry on|go{es} ahead|resume{s}|continue the mission|"
        "resume the mission|go on with the mission|proceed"
    ),
    ("RECHARGE", None): "recharge{s}|charge{s}|recharge the battery|charge the battery",
    ("REPORT", None): "report it|report this|report|report that",
    ("REPEAT", None): "repeat|run|perform|execute",
    ("DO_FOLLOWING", None): "do the following|do this",
    ("ADD", None): "add|insert",
    ("DELETE", None): "delete|remove",
    ("REPLACE", None): "replace|exchange",
    ("MOVE", None): "move",
    ("JUMP", None): "skip to|jump to|continue with|go on with|proceed with|carry on with",
    ("RETRY", None): "retry|try again|try it again|retry it",
    ("DONE", None): "done|that is all",
    ("MEET", None): "go on here",
    ("START_HERE", None): "start here",
    ("MAX_DURATION", None): (
        "mission may take|mission takes|maximum duration of the mission is|maximum duration is|"
        "please note that the maximum duration of the mission is"
    ),
    ("BACK_IN", None): "it has to be back in|robot has to be back in|it must be back in",
    ("ROUND_DRIVEN", None): "are a round that is driven|are driven|are repeated|are a round driven",
}

NOUNS: Phrases = {
    ("KIND", (Kind.CHECKPOINT, False)): "checkpoint|check point",
    ("KIND", (Kind.CHECKPOINT, True)): "checkpoints|check points",
    ("KIND", (Kind.VALVE, False)): "valve",
    ("KIND", (Kind.VALVE, True)): "valves",
    ("KIND", (Kind.PRESSURE_GAUGE, False)): "pressure gauge|manometer",
    ("KIND", (Kind.PRESSURE_GAUGE, True)): "pressure gauges|manometers",
    ("KIND", (Kind.LIQUID_LEVEL_GAUGE, False)): "liquid level gauge|level gauge",
    ("KIND", (Kind.LIQUID_LEVEL_GAUGE, True)): "liquid level gauges|level gauges",
    ("KIND", (Kind.GAUGE, False)): "gauge",
    ("KIND", (Kind.GAUGE, True)): "gauges",
    ("HASH", None): "#|no .|nr .|number|no|nr",
    ("STEP", None): "step{s}|task{s}",
    ("FLOOR", False): "floor|deck|storey",
    ("FLOOR", True): "floors|decks|storeys",
    ("FLOOR_NAME", "bottom"): "ground floor|lowest floor|bottom floor",
    ("FLOOR_NAME", "top"): "top floor|highest floor|uppermost floor",
    ("AREA", None): "starting area|area",
    ("DOCK", None): "dock{s}|docking station|docking bay|its dock|charging station",
    ("ALL", None): "all|each|all of",
    ("EXCEPT", None): "except|except for|but not|apart from|but don't check|but do not check",
    ("IT", None): "it|that one",
    ("THEM", None): "them|both|both of them",
    ("THIS", None): "this|that",
    ("OF", "value"): "value of|value on|reading of|reading on|value at",
    ("OF", "position"): "position of|position on",
    ("OF", "level"): "level of|level on",
    ("OF", "pressure"): "pressure of|pressure on",
    ("VALUE", "value"): "value|its value|reading",
    ("VALUE", "pressure"): "pressure|its pressure",
    ("VALUE", "level"): "level|its level",
    ("VALUE", "position"): "position|its position",
    **{
        ("ORDINAL", n): f"{word}|{n}{suffix}"
        for n, (word, suffix) in enumerate(
            zip(
                expand("first|second|third|fourth|fifth|sixth|seventh|eighth|ninth|tenth"),
                expand("st|nd|rd|th|th|th|th|th|th|th"),
                strict=True,
            ),
            start=1,
        )
    },
}

CONDITIONS: Phrases = {
    ("IF", None): "if|when|whenever|in case {of}|in the event of|as soon as",
    ("UNLESS", None): "unless",
    ("ELSE", None): "otherwise|else|if not",
    ("IN_ALL_OTHERS", None): "in all other cases|in any other case",
    ("LAST_ROUND", None): "after the last round",
    ("TOO_LATE", None): "it is too late|too late|it is too late for that",
    ("OLDER", None): "older than",
    ("UNTIL", None): "until|till",
    ("IS", None): "is|are|was|were|shows|show|lies|gets|becomes|drops|rises|falls",
    ("NOT", None): "not|isn't|does not|do not|don't|is not|are not|was not|never",
    ("GREATER", None): "greater than|more than|higher than|larger than|above|over|exceeds|>",
    ("LESS", None): "less than|lower than|smaller than|below|under|<",
    ("AT_LEAST", None): "at least|>=|no less than|not less than|greater than or equal to",
    (
        "AT_MOST",
        None,
    ): "at most|<=|no more than|not more than|less than or equal to|up to",
    ("TAKING", None): "taking at most",
    ("MINUS", None): "minus",
    ("BETWEEN", None): "between",
    ("FROM", None): "from",
    (
        "STATE",
        "normal",
    ): "normal|in its normal range|within its normal range|in its normal position",
    ("STATE", "abnormal"): (
        "abnormal|outside its normal range|out of its normal range|not in its normal position|"
        "not normal|not in its normal range"
    ),
    ("STATE", "unreadable"): "unreadable|can't be read|cannot be read|could not be read",
    ("FAILS", None): "fails|has failed|failed|still fails|does not work|does not succeed",
    ("OCCURS", None): (
        "is detected|is found|is heard|is seen|occurs|happens|sounds|appears|is pressed"
    ),
    ("BATTERY", None): "battery|battery level|charge of the battery|battery charge",
    ("EVENT", EventKind.GAS_LEAK): "gas leak{s}|gas leakage",
    ("EVENT", EventKind.HOT_SPOT): "hot spot{s}|hotspot{s}",
    ("EVENT", EventKind.ABNORMAL_SOUND): "abnormal {pump} sound|abnormal {pump} noise",
    ("EVENT", EventKind.PLATFORM_ALARM): "{general} platform alarm|gpa|evacuation alarm ( gpa )",
    ("EVENT", None): "obstacle{s}",
    ("EVENT", EventKind.POSITIVE_OBSTACLE): "positive obstacle{s}",
    ("EVENT", EventKind.NEGATIVE_OBSTACLE): "negative obstacle{s}",
    ("EVENT", EventKind.LOW_BATTERY): "low battery|battery is low",
    (
        "EVENT",
        EventKind.CONNECTION_LOST,
    ): "connection loss|connection lost|connection is lost|loss of connection",
    ("EVENT", EventKind.EMERGENCY_STOP): "emergency stop",
    ("EVENT", EventKind.DYSFUNCTION): "dysfunction|malfunction",
    ("EVENT", EventKind.ABNORMAL_READING): (
        "abnormal reading|abnormal value|a reading is outside its normal range|"
        "any reading is outside its normal range|a value is outside its normal range|"
        "any value is outside its normal range|a reading is abnormal|any reading is abnormal"
    ),
    ("EVENT", EventKind.TIME_UP): "time is up|time is over",
    ("EVENT", EventKind.ALL_CLEAR): "all-clear|all clear|all clear is given|danger is over",
    (
        "EVENT",
        EventKind.BATTERY_CHARGED,
    ): "battery is charged|battery is full|battery charged|battery full",
    (
        "EVENT",
        EventKind.CONNECTION_RESTORED,
    ): "it is restored|connection is restored|connection restored",
}

MANNERS: Phrases = {
    ("TO", None): "to|into",
    ("IN", None): "in|inside",
    ("AT", None): "at|at the|at speed of|with speed of",
    ("ON", None): "on|onto",
    ("FOR", None): "for",
    ("PERSON", None): "operator|a person|supervisor",
    ("EVERY", None): "every",
    ("TIMES", Figure(1.0)): "once",
    ("TIMES", Figure(2.0)): "twice",
    ("MORE", Figure(1.0)): "again|once more|one more time|a second time",
    ("MORE_WORD", None): "more|further",
    ("TIME_WORD", None): "time{s}|round{s}",
    ("WITHIN", None): "within|within the first|in at most",
    ("MEASURING", None): "measuring of|measurement of",
    ("EVERYTHING", None): "everything|all steps",
    ("BY", None): "by|with",
    ("BEFORE", None): "before",
    ("AFTER", None): "after",
    ("LATEST", None): "not later than|no later than|at the latest",
    ("SINCE_START", None): "after the start|after mission start|after the mission's start",
    ("IF_TIME", None): "if there is time|time permitting|if time allows|if time permits",
    ("PRIORITY", None): "with priority|priority",
    ("ANY_ORDER", None): (
        "in any order|in whatever order is best|in whichever order is best|in the best order|"
        "in whatever order|in an arbitrary order|in any sequence|in whatever order you like|"
        "in whatever order is quickest|in the order that is best"
    ),
    ("ORDER_FREE", None): (
        "order does not matter|order doesn't matter|order is free|order is not important|"
        "order is up to you|order is not fixed|you may choose the order|"
        "they may be visited in any order|they can be visited in any order|"
        "they may be done in any order|they can be done in any order|"
        "checkpoints may be visited in any order|checkpoints can be visited in any order|"
        "steps may be done in any order|steps can be done in any order"
    ),
    ("THIS_ORDER", None): "in this order|in this precise order|in the given order",
    ("TOTAL", None): "in total|in all|altogether",
    ("MODE", Mode.AUTONOMOUS): "autonomous{ly}",
    ("MODE", Mode.SUPERVISORY): "supervisory",
    ("UPTO", None): "through",
    ("FINISHING", None): "finishing the round|finishing its round|completing the round",
    ("STOPPING", None): "stopping at once|stopping immediately",
    ("ENDLESS", None): "endlessly|forever|without end",
    ("INCLUDED", None): "interruptions included",
    ("EXCLUDED", None): "interruptions excluded",
    ("IN_CIRCLES", None): "in circles|in rounds|in a circle",
    ("STANDING", None): "standing at",
    ("SHOWN_IN", None): "shown in",
    ("ABOUT", None): "about object",
    ("JOINTS", None): "with joints|with joint",
    ("VELOCITIES", None): "velocities",
    ("EFFORTS", None): "efforts",
    ("READING", None): "reading for at most|reading for up to",
    ("OR_ELSE", None): "or else",
    ("PREFERABLY", None): "preferably|if possible",
    ("ANY_TIME", None): "at any time",
    ("LEAVING", None): "leaving at",
    ("AGE", None): "measured within the last|measured in the last|not older than|within the last",
    ("LPAR_CALLED", None): "( called",
    ("LPAR_BOUND", None): "( with second bound",
    ("SECOND_BOUND", None): "with second bound",
    ("X", None): "x",
    ("Y", None): "y",
    ("Z", None): "z",
    ("HEADING", None): "heading",
    ("RAD", None): "rad",
    ("EARLIEST", None): "not before|no earlier than|not earlier than",
    ("UNIT_S", 86400.0): "day{s}",
    ("UNIT_S", 3600.0): "h|hour{s}|hrs|hr",
    ("UNIT_S", 2700.0): "three-quarter hour",
    ("UNIT_S", 1800.0): "half-hour{s}",
    ("UNIT_S", 900.0): "quarter of an hour|quarters of an hour|quarter-hour{s}|quarter hour{s}",
    ("UNIT_S", 60.0): "min|mins|minute{s}|'",
    ("UNIT_S", 1.0): "s|sec|secs|seconds",
    (
        "RATE",
        1.0,
    ): "m / s|metre{s} per second|meter{s} per second|metre{s} a second|meter{s} a second",
    ("RATE", 0.01): "cm / s|centimetre{s} per second|centimeter{s} per second",
    ("RATE", 1 / 3.6): "km / h|kmh|kph|kilometre{s} per hour|kilometer{s} per hour",
}

_UNITS = expand("one|two|three|four|five|six|seven|eight|nine")
_TEENS = expand("ten|eleven|twelve|thirteen|fourteen|fifteen|sixteen|seventeen|eighteen|nineteen")
_TENS = expand("twenty|thirty|forty|fifty|sixty|seventy|eighty|ninety")

FIGURES: Phrases = {
    **{("NUMBER_WORD", n): word for n, word in enumerate(_UNITS + _TEENS, start=1)},
    ("NUMBER_WORD", 12): "twelve|dozen",
    **{
        ("NUMBER_WORD", n + 0.5): f"{word} and a half"
        for n, word in enumerate(_UNITS + _TEENS, start=1)
    },
    **{("NUMBER_WORD", 10 * n): word for n, word in enumerate(_TENS, start=2)},
    **{
        ("NUMBER_WORD", 10 * n + k): f"{ten}-{unit}|{ten} {unit}"
        for n, ten in enumerate(_TENS, start=2)
        for k, unit in enumerate(_UNITS, start=1)
    },
    ("NUMBER_WORD", 100): "hundred|hundred and",
    ("NUMBER_WORD", 1000): "thousand|thousand and",
    ("UNIT", "bar"): "bar{s}",
    ("UNIT", "mbar"): "mbar|millibar{s}",
    ("UNIT", "psi"): "psi",
    ("UNIT", "Pa"): "pa|pascal{s}",
    ("UNIT", "hPa"): "hpa|hectopascal{s}",
    ("UNIT", "kPa"): "kpa|kilopascal{s}",
    ("UNIT", "MPa"): "mpa|megapascal{s}",
    ("UNIT", "atm"): "atm|atmospheres",
    ("UNIT", "%"): "%|percent|per cent",
    ("UNIT", "deg"): "°|deg|degree{s}",
    ("UNIT", "rad"): "radian{s}",
    ("UNIT", "degC"): "° c|degree{s} celsius|deg c",
    ("UNIT", "degF"): "° f|degree{s} fahrenheit|deg f",
    ("UNIT", "mm"): "mm|millimetre{s}|millimeter{s}",
    ("UNIT", "cm"): "cm|centimetre{s}|centimeter{s}",
    ("UNIT", "m"): "m|metre{s}|meter{s}",
    ("UNIT", "l"): "litre{s}|liter{s}",
    ("UNIT", "kg"): "kg|kilogram{s}",
    ("HALF", None): "half",
}

JOINTS: Phrases = {
    ("JOINT", "and"): "and|as well as",
    ("JOINT", "or"): "or",
}

PARTS = (NOTHING, VERBS, NOUNS, CONDITIONS, MANNERS, FIGURES, JOINTS)
