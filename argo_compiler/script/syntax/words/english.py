"""The words of English. `check{s}` is two words, bars separate phrases."""

from argo_compiler.il import EventKind, Mode
from argo_compiler.script.syntax.tree.nouns import Kind
from argo_compiler.script.syntax.words.lexicon import Phrases, expand
from argo_compiler.script.syntax.words.numbers import Figure

NOTHING: Phrases = {
    ("FILLER", None): (
        "the|a|an|please|either|please to|go [up/down/over/there] and|kindly|just|then|there|"
        "straight|directly|at once|immediately|right away|"
        "now|as well|too|also|could you please|could you|can you please|would you please|"
        "i would like you to|we need you to|have|let|make sure to|should|must|will|shall|has to|"
        "have to|will have to|"
        "is to|needs to|robot|it should|it has to|it must|it will|it shall|it is to|let it|have it|"
        "after that|afterwards|finally|first of all|at the end|in the end|next|subsequently|"
        "of them|of these|of those|after this|from there|so|when you are done|when done|"
        "when finished|general rule|where the robot stands|where it stands|send the robot out|its|"
        "its own|own|lastly|last of all|as a [last/first/final] step|"
        "as the [last/first/final] step|to [begin/start] with|firstly|secondly|thirdly|in addition|"
        "additionally|furthermore|moreover|besides {that}|instead|only|simply|at last|"
        "after doing so|[once/when] [this/that] is done|once [done/finished]|i want you to|"
        "[i/we] would like {you} to|[i/we] want it to|i'd like you to|you [should/have to]|would|"
        "[is/are] [supposed/going] to|are to|can|could|make sure {that}|be sure to|"
        "[remember/don't forget/do not forget] to|go ahead and|[i/we] need|i need you to|ought to|"
        "along the way|on [the/its] way|over there|pls|plz|thereafter|thereupon|if so|"
        "in [that/this] case|respectively|each time|with it|in turn|"
        "one [by one/after the other/after another]|mobile robot|inspection robot"
    ),
    ("IDLE", None): (
        "today|tonight|tomorrow|this morning|this evening|carefully|this [afternoon/week]|"
        "on [monday/tuesday/wednesday/thursday/friday/saturday/sunday]|thoroughly|safely|cautiously"
    ),
}

VERBS: Phrases = {
    ("MEASURE", None): (
        "check{s} {up} {on}|measure{s}|re-measure{s}|remeasure{s}|read{s} [out/off/]|re-read{s}|"
        "reread{s}|recheck{s}|re-check{s}|double-check{s}|inspect{s}|control{s}|verif[y/ies]|"
        "examine{s}|investigate{s}|record{s}|log{s}|register{s}|note{s} {down}|survey{s}|test{s}|"
        "scan{s}|observe{s}|visit{s}|look{s} [at/into]|[have/has/take/takes] a look at|"
        "[take/takes/get/gets/make/makes] [a/the] [reading/measurement] [of/at/from/on]|"
        "take{s} readings of|get{s} the value of|"
        "[do/perform/carry out/does/performs/carries out] a [check/measurement/reading] [of/on/at]|"
        "go and [check/read/measure]|go [check/read/measure]|measuring|checking"
    ),
    ("KEEP_MEASURING", None): (
        "[keep/keeps/go on/continue/continues] {on} [reading/checking/measuring/monitoring/"
        "watching]|"
        "[continue/continues] to [read/check/measure/monitor]|monitor{s}|watch{es}|"
        "keep{s} an eye on"
    ),
    ("BE_MEASURED", None): (
        "[has to/have to/must/should/shall/is to/are to/needs to/need to/will/can] be [read/"
        "checked/measured/inspected/visited/done]|"
        "[is/are] [read/checked/measured/inspected/visited]|[comes/come]"
    ),
    ("GO", None): (
        "[go/goes/drive/drives/travel/travels/head/heads/move/moves/navigate/navigates/run/runs] "
        "[back/up/down/over/on/out/along/] [to/into]|"
        "[come/comes/get/gets] {back} [to/into]|"
        "[go/goes/drive/drives/head/heads/navigate/navigates]|return{s} [to/into]|proceed{s} to|"
        "back to|advance{s} to|head{s} for|[make/makes] its way {back} to|approach{es}|"
        "[bring/send] the robot {back} to|returning to"
    ),
    ("HOME", None): (
        "[go/goes/drive/drives/come/comes/return/returns/head/heads/get/gets/move/moves/travel/"
        "travels] {back} home|"
        "[go/goes/drive/drives/come/comes/head/heads/get/gets] back|return{s} {back}|"
        "[go/goes/return/returns/drive/drives] {back} to base|{back} home|back to base|"
        "return{s} to home"
    ),
    ("PARK", None): "park{s} {itself}|plug{s} in|dock{s} itself",
    ("START", None): (
        "start{s} [out/off/] {from}|begin{s} {from}|leave{s} {from}|depart{s} {from}|"
        "set{s} out from|starting [from/at]|set start|[set/sets] [starting/start] [point/position]|"
        "[starting/start] [point/position] {is}|"
        "is [waiting/standing/parked/located/placed/positioned/docked]|stands|"
        "[begin/begins/start/starts] [the/its] [mission/round/tour]|"
        "[mission/round/tour/it all] [starts/begins] {from}"
    ),
    ("ROUNDS_OF", None): "[rounds/laps/tours] [of/on/around/through]",
    ("PATROL", None): (
        "patrol{s}|patrolling|"
        "[make/do/perform/makes/does/performs] a [patrol/round/tour] [of/on/around]|"
        "[go/goes] on patrol [on/around]|patrol{s} [on/around/along]|tour{s}|circle{s}|"
        "[walk/walks/drive/drives/go/goes] around"
    ),
    ("WAIT", None): (
        "[wait/waits/stay/stays/remain/remains] [there/here/in place/put/]|stand{s} by|idle|"
        "stand there|stands there"
    ),
    ("PAUSE", None): (
        "pause{s} {mission}|stop{s} [moving/round/]|halt{s}|[stand/stands/remain/keep] still|"
        "hold{s} [on/position/its position/]|freeze|interrupt{s} the mission|"
        "suspend{s} the mission|[come/comes] to a [stop/halt]|stop{s} where it is"
    ),
    ("END", None): (
        "end{s} [mission/round/it/] [there/here/]|"
        "[finish/finishes/stop/stops/terminate/terminates/close/complete/conclude] mission "
        "[there/here/]|"
        "mission [ends/is over/is finished/is ended/is complete] [there/here/]|"
        "[that is/this is/] end of mission|terminate{s}|quit"
    ),
    ("ABORT", None): (
        "[abort/aborts/cancel/cancels/abandon/abandons/call off/break off] [mission/everything/"
        "run/round/]|"
        "mission is {to be} [aborted/cancelled]|stop everything"
    ),
    ("GO_ON", None): (
        "[go/goes/carry/carries/move/moves/drive/drives] on [as planned/as usual/anyway/]|"
        "[continue/continues/proceed/proceeds/resume/resumes] [as planned/as usual/as normal/"
        "normally/anyway/]|"
        "go{es} ahead|keep{s} going|"
        "[go on/carry on/continue/proceed/continues/goes on/move on] [with/to] the [mission/"
        "round/rest/inspection/next step/next one/next checkpoint]|"
        "go{es} {on} to the next [step/one/checkpoint]|"
        "[continue/continues/resume/resumes] [the/its] [rest/rest of the mission/inspection/"
        "mission/round/work/tour]|"
        "[skip/skips/ignore/ignores] [it/this/that/that one/this one]|leave it out|leaves it out|"
        "just go on|"
        "[continue/resume/carry on/go on/continues/resumes/goes on/pick up] {from} where [it/"
        "you] [left off/stopped/was/were]|"
        "never mind"
    ),
    ("RECHARGE", None): (
        "[recharge/recharges/charge/charges] [up/fully/there/battery/its battery/it/]|"
        "[be/get/gets] [charged/recharged]|top up the battery"
    ),
    ("REPORT", None): (
        "report{s} [it/this/that/event/finding/]|only report it|"
        "[tell/inform/notify/inform] the operator|let the operator know|"
        "[make/send/raise] a [report/note]|[note/log/record] it|take note of it"
    ),
    ("REPEAT", None): (
        "repeat{s}|redo|do|run|perform|execute|carry out|[run/go/cycle/loop] through|loop {over}|"
        "iterate {over}"
    ),
    ("DO_FOLLOWING", None): (
        "[do/perform/execute/run/repeat/carry out] [following/these/following steps/these steps/"
        "steps below]|"
        "do this|following {steps}"
    ),
    ("ADD", None): "add{s}|insert{s}|include|put in",
    (
        "DELETE",
        None,
    ): "delete|remove|strike {out}|cross out|take out|leave out|omit|erase|skip|scrap|cut",
    ("REPLACE", None): "replace|exchange|substitute",
    ("MOVE", None): "move",
    ("JUMP", None): (
        "[skip/jump] [ahead/back/] to|"
        "[continue/go on/proceed/carry on/resume/go ahead/start again/go straight on] [with/at/"
        "from]"
    ),
    ("RETRY", None): (
        "retry {it}|retries|try {it} {again}|attempt it again|"
        "repeat the [reading/measurement/check/attempt]|reattempt {it}"
    ),
    ("DONE", None): (
        "done|all done|finished|that [is/was] [all/it]|that's [all/it]|mission complete{d}|"
        "end of {the} [script/protocol]|nothing [else/more]"
    ),
    ("MEET", None): "go on here",
    ("START_HERE", None): "start here",
    ("MAX_DURATION", None): (
        "[mission/whole mission/round/whole round/whole thing/everything/all this/it/this/robot/"
        "all in all it] [may/can/should] {only} [take/last]|"
        "[mission/whole mission/round/it] [takes/lasts] {up}|"
        "[mission/robot/it/you/we] {only} [has/have]|"
        "[maximum/max/max ./total/allowed] [total/] {mission} [duration/time] {of the mission} "
        "{is}|"
        "duration of the mission is|time limit {of the mission} is|time available is|"
        "[time/duration/mission] is limited to|"
        "[mission/whole mission/round/it/robot] [must/may/should] not [take/last] {any} longer "
        "than|"
        "please note that the maximum duration of the mission is"
    ),
    ("KEEP_ORDER", None): "keep|always do",
    ("BACK_IN", None): "it has to be back in|robot has to be back in|it must be back in",
    ("ROUND_DRIVEN", None): "are a round that is driven|are driven|are repeated|are a round driven",
}

NOUNS: Phrases = {
    (
        "KIND",
        (Kind.CHECKPOINT, False),
    ): (
        "checkpoint|check-point|check point|cp|chkpt|[measuring/measurement/inspection/control/"
        "test] point"
    ),
    (
        "KIND",
        (Kind.CHECKPOINT, True),
    ): (
        "checkpoints|check-points|check points|cps|[measuring/measurement/inspection/control/test] "
        "points"
    ),
    ("KIND", (Kind.VALVE, False)): "valve",
    ("KIND", (Kind.VALVE, True)): "valves",
    ("KIND", (Kind.PRESSURE_GAUGE, False)): "pressure [gauge/gage/meter/indicator/dial]|manometer",
    (
        "KIND",
        (Kind.PRESSURE_GAUGE, True),
    ): "pressure [gauges/gages/meters/indicators/dials]|manometers",
    (
        "KIND",
        (Kind.LIQUID_LEVEL_GAUGE, False),
    ): "[liquid/level/liquid level/liquid-level/fill level] [gauge/gage/meter/indicator]",
    (
        "KIND",
        (Kind.LIQUID_LEVEL_GAUGE, True),
    ): "[liquid/level/liquid level/liquid-level/fill level] [gauges/gages/meters/indicators]",
    ("KIND", (Kind.GAUGE, False)): "gauge|gage",
    ("KIND", (Kind.GAUGE, True)): "gauges|gages",
    ("HASH", None): "#|no .|nr .|number|no|nr|numbers|nos .|nos|with the number",
    ("STEP", None): "step{s}|task{s}|item{s}|point{s}|stage{s}|line{s}|instruction{s}",
    ("NEXT_STEP", None): "[next/following] [step/point/item/task/one/instruction]",
    ("FLOOR", False): "floor|deck|storey|story",
    ("FLOOR", True): "floors|decks|storeys|stories",
    (
        "FLOOR_NAME",
        "bottom",
    ): "[ground/lowest/bottom/lowermost] [floor/deck/level/storey]|ground-floor",
    ("FLOOR_NAME", "top"): "[top/highest/uppermost/topmost] [floor/deck/level/storey]",
    ("AREA", None): "starting area|area|starting zone",
    ("DOCK", None): (
        "dock{s}|dock station|[docking/charging] [station/bay/point/port/dock]|docking-station|"
        "charger|home [base/dock/position/station]|parking position|base {station}|homebase"
    ),
    ("ALL", None): "all {of}|each {of}|every one of|each and every|every single",
    ("EXCEPT", None): (
        "except {for}|but not|but don't check|but do not check|apart from|save {for}|excluding|"
        "other than|but without|without|leaving out|with the exception of|excepting|"
        "but [leave out/skip/omit]|skipping|not including"
    ),
    ("IT", None): "it|that one|this one",
    ("BOTH", None): "both [of them/of these/of those/]",
    ("THEM", None): "them|they|these|those|[all/each] of [them/these/those]|these two",
    ("THEM", "either"): (
        "[at least/] one of [them/these/those]|any of [them/these/those]|any one of them|"
        "either [of them/of these/of those/one]"
    ),
    ("THIS", None): "this|that",
    (
        "OF",
        "value",
    ): (
        "[value/values/reading/readings/result/measured value/display] [of/on/at/from/shown by/"
        "shown on]"
    ),
    ("OF", "position"): "[position/positions/setting/opening] [of/on/at]",
    (
        "OF",
        "level",
    ): (
        "[level/levels/liquid level/liquid levels/fill level/filling level] [of/on/at/in/shown by/"
        "shown on]"
    ),
    ("OF", "pressure"): "[pressure/pressures] [of/on/at/in/shown by/shown on]",
    ("VALUE", "value"): (
        "[value/reading/result/measurement/measured value/indication] {there}|"
        "[this/that] [value/reading/result/measurement]|what it shows"
    ),
    ("VALUE", "pressure"): "{measured} pressure {reading} {there}|[this/that] pressure",
    (
        "VALUE",
        "level",
    ): "{measured} {liquid} level {reading} {there}|[this/that] level|[fill/filling] level",
    (
        "VALUE",
        "position",
    ): "{valve} position {there}|this position|{opening} angle|[setting/opening]",
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
    ("IF", None): (
        "if|when|whenever|in case [of/that/]|in the case [of/that/]|in the event [of/that]|"
        "in event of|in cases of|as soon as|on condition that|provided {that}|given that|"
        "assuming {that}|every time|"
        "if [ever/at any time/during the mission/during the round/meanwhile/in the meantime/it "
        "happens that/it turns out that]|"
        "at any time if|upon|should there be|if and when|supposing"
    ),
    ("UNLESS", None): "unless|except [if/when/in case]|but not [if/when]",
    ("ELSE", None): (
        "otherwise|or otherwise|else|elsewise|if not|if [it/that/this] is not [the case/so]|"
        "if [it/that/this] isn't [the case/so]|in [the other case/other cases]"
    ),
    ("IN_ALL_OTHERS", None): "in all other cases|in any other case",
    ("LAST_ROUND", None): "after the last round",
    ("TOO_LATE", None): "it is too late|too late|it is too late for that",
    ("OLDER", None): "older than",
    ("UNTIL", None): "until|till|up until",
    ("IS", None): (
        "is|are|was|were|be|being|has|had|lies|lie|gets|becomes|become|has become|drops|rises|rise|"
        "falls|fall|climbs|climb|sinks|sink|[drops/falls/rises/climbs] to|"
        "has [dropped/fallen/risen/gone]|amounts to|comes out|turns out {to be}|proves|"
        "is found to be|"
        "[shows/show/indicates/indicate/displays/display/gives/has/reads] [value/pressure/level/"
        "position/reading] {of}|"
        "[shows/show/indicates/indicate/displays/display/exhibits]|"
        "is [now/still/already/then/currently]|are still|still is|then is|is read as|is showing|"
        "is reading"
    ),
    ("NOT", None): (
        "not|[is/are/was/were/does/do/did/has/have] not|isn't|aren't|wasn't|weren't|doesn't|don't|"
        "didn't|hasn't|haven't|never|{is} no longer|not any more|{is} not yet"
    ),
    ("GREATER", None): (
        "[is/] [greater/more/higher/larger/bigger] [than/as]|{strictly} above|{strictly} over|"
        "[goes/rises/climbs/gets/is] [above/over/beyond]|exceed{s}|exceeding|has exceeded|"
        "in excess of|beyond|surpass{es}|>"
    ),
    ("LESS", None): (
        "[is/] [less/lower/smaller/fewer] [than/as]|{strictly} below|{strictly} under|"
        "[goes/falls/drops/sinks/gets/is] [below/under/beneath]|beneath|underneath|undershoots|<"
    ),
    ("AT_LEAST", None): (
        "at least|>=|≥|[no/not] [less/lower/smaller/fewer] than|not [below/under]|"
        "[is/] [greater/more/higher/larger] than or equal to|[is/] [greater/above] or equal {to}|"
        "equal {to} or [greater than/more than/above]|reach{es}|reached|has reached|a minimum of|"
        "minimum of"
    ),
    ("AT_MOST", None): (
        "at most|<=|≤|[no/not] [more/higher/greater/larger/bigger] than|not [above/over/exceeding]|"
        "[is/] [less/lower/smaller] than or equal to|[is/] [less/below] or equal {to}|"
        "equal {to} or [less than/below]|up to {and including}|does not exceed|doesn't exceed|"
        "maximum of|maximum|max|max .|maximally|limited to"
    ),
    ("TAKING", None): "taking at most",
    ("MINUS", None): "minus",
    ("OR_MORE", "or"): "or [more/higher/greater/above/over/larger/upwards]",
    ("OR_MORE", "and"): "and [more/higher/greater/above/over/larger/upwards]",
    ("OR_LESS", "or"): "or [less/lower/below/under/smaller/fewer]",
    ("OR_LESS", "and"): "and [less/lower/below/under/smaller/fewer]",
    ("EXACTLY", None): "exactly|[equal/equals/exactly equal] {to}|precisely|=",
    ("BETWEEN", None): (
        "between|in between|[in/within/inside] the [range/interval/band/limits] [of/between]|"
        "[somewhere/anywhere/anything] between"
    ),
    ("FROM", None): "from",
    ("STATE", "normal"): (
        "normal|"
        "[in/within/inside] [its/the/their] [normal/nominal/usual/allowed] [range/limits/band]|"
        "[in/within] [range/limits/normal limits/specification/spec/tolerance]|"
        "in {its} normal [position/state]|in order|as expected|fine|nominal|as usual|in the green|"
        "as it should be"
    ),
    ("STATE", "abnormal"): (
        "abnormal|anomalous|irregular|off-normal|unnormal|"
        "not [normal/nominal/ok/okay/fine/in order/as expected/as it should be/in range/within "
        "range]|"
        "[outside/outside of/out of/beyond/not in/not within/not inside] [its/the/their] [normal/"
        "nominal/usual/allowed] [range/limits/band]|"
        "not in {its} normal position|"
        "out of [range/its range/limits/order/tolerance/spec/specification/normal range]|"
        "outside [its range/its limits/normal limits/normal range]|an anomaly"
    ),
    ("STATE", "unreadable"): (
        "unreadable|illegible|not [readable/legible]|[is/was] [impossible/not possible] to read|"
        "[gives/delivers/shows/has] no [reading/value]|does not give a [reading/value]"
    ),
    ("FAILS", None): (
        "fail{s} {again}|{it} {has} failed {again}|failure|still fails|"
        "{still} [does not/doesn't/did not/didn't] [work/work out/succeed/go through]|goes wrong|"
        "went wrong|[is/was] [not successful/unsuccessful/not possible/impossible]|"
        "isn't [successful/possible]|has still failed|keeps failing|"
        "[can't/cannot/can not/couldn't/could not] be [read/read out/read off/measured/"
        "determined] {at all}|"
        "[cannot/can't/could not] be done|[is/was] unable to be read"
    ),
    ("OCCURS", None): (
        "[is/are/was/were/has been/have been] [detected/found/heard/seen/noticed/reported/"
        "discovered/observed/sensed/perceived/recognised/recognized/identified/encountered/met] "
        "[anywhere/somewhere/at any time/during the mission/on the way/]|"
        "[is/has been] [raised/triggered/given/activated/pressed/pushed/hit/used/sounded/"
        "announced]|"
        "occur{s}|sound|happen{s}|appear{s}|arise{s}|sounds|rings|goes off|comes on|comes up|"
        "shows up|"
        "turns up|pops up|breaks out|is present|is active|is there|has occurred|detected|found|"
        "heard|seen|anywhere|during the [mission/round]|at any [point/moment]"
    ),
    ("BATTERY", None): (
        "battery [level/status/state/charge/charge level/]|"
        "[charge/level/state/charging level] of {its} battery|state of charge|"
        "[battery's/robot's] [charge/battery/level]|remaining [battery/charge]|"
        "[charge/charging/power] level|soc"
    ),
    ("EVENT", EventKind.GAS_LEAK): (
        "gas leak{s}|gas leakage{s}|[leak/leakage/escape/release] of gas|"
        "gas [escape/alarm/release/leaking]|[leaking/escaping] gas|"
        "gas is [detected/smelled/found/leaking]|methane leak|gas"
    ),
    ("EVENT", EventKind.HOT_SPOT): (
        "hot spot{s}|hotspot{s}|hot-spot{s}|heat spot|hot surface|overheating|"
        "overheated [spot/part/component]|thermal anomaly"
    ),
    ("EVENT", EventKind.ABNORMAL_SOUND): (
        "[abnormal/strange/unusual] {pump} [sound/noise/sounds/noises]|"
        "[abnormal/strange/unusual] [sound/noise] [of/from] pump|pump sounds [abnormal/strange]|"
        "pump [makes/is making] [abnormal/strange/unusual] [sound/noise/sounds/noises]|"
        "sound of a pump is abnormal|[sound/acoustic] anomaly"
    ),
    ("EVENT", EventKind.PLATFORM_ALARM): (
        "{general} platform alarm{ ( gpa )}|gpa{ alarm}|{general} alarm [of/on] the platform|"
        "evacuation alarm{ ( gpa )}|evacuation signal|general alarm|[site/plant] alarm|"
        "alarm of the site"
    ),
    ("EVENT", EventKind.LOW_BATTERY): (
        "low [battery/charge] [warning/level/]|"
        "battery [level/charge/] [is/gets/goes/runs/becomes/is running/is getting] {too} low|"
        "[charge/battery's charge] is low|battery is [almost/nearly/close to] empty|"
        "battery [low/nearly empty/is weak/warning/alarm/runs out/runs down/is running out/needs "
        "charging/must be charged]|"
        "weak battery|low on battery"
    ),
    ("EVENT", EventKind.CONNECTION_LOST): (
        "[connection/communication/contact/signal/link/network/network connection/radio contact/"
        "radio link/wireless connection/wifi/wi-fi] [to the control room/to the operator/to the "
        "control station/to the base station/to the robot/] [is lost/gets lost/is broken/is "
        "interrupted/is down/breaks/breaks off/breaks down/fails/drops/goes down]|"
        "[connection/communication/signal] [loss/lost]|loss of [connection/communication/contact/"
        "signal]|"
        "lost [connection/communication]|[robot/it] loses {its} [connection/contact/signal]|"
        "no connection"
    ),
    ("EVENT", EventKind.EMERGENCY_STOP): (
        "emergency stop{ button}|emergency stop is pressed|emergency [switch/button/halt/shutdown]|"
        "emergency-stop|e-stop{ button}|estop"
    ),
    ("EVENT", EventKind.DYSFUNCTION): (
        "{technical} [dysfunction/malfunction/fault/defect/error] [of the robot/in the "
        "robot/on the robot/]|technical failure|failure of the robot|"
        "robot [dysfunction/malfunction/fault/defect/failure/error/breakdown]|"
        "robot has a [malfunction/fault/defect/problem/error]|"
        "[robot/it] [malfunctions/breaks down]|robot is [defective/faulty/broken]|"
        "technical problem|problem with the robot|[internal/hardware/system] [error/fault/failure]"
    ),
    ("EVENT", EventKind.ABNORMAL_READING): (
        "{any} [abnormal/anomalous] {measured} [reading/value/measurement/readings/values]|"
        "[a/any/any other/some/one] [reading/value/measured value/measurement/checkpoint/gauge] "
        "is [abnormal/anomalous/not normal/out of range/outside its normal range/outside the "
        "normal range/out of its normal range]|"
        "one of the [readings/values/checkpoints] is [abnormal/not normal/out of range/outside "
        "its normal range]|"
        "any of the [readings/values/checkpoints] is [abnormal/not normal/out of range/outside "
        "its normal range]|"
        "[reading/value] [outside its normal range/outside the normal range/out of range]|"
        "[a/any] [reading/value] lies outside [its/the] normal range|"
        "something abnormal is [read/measured]|any anomaly"
    ),
    ("EVENT", EventKind.POSITIVE_OBSTACLE): (
        "positive obstacle{s}|"
        "[obstacle/obstacles/object/something] [in/on/stands in/stands on/lies in/lies on/is in/"
        "is on] [the/its/his] [way/path/route]|"
        "[obstacle/object/something] [blocks/is blocking/obstructs] [the/its] [way/path/route]|"
        "[way/path/route] is [blocked/obstructed]|blocked [way/path]"
    ),
    ("EVENT", EventKind.NEGATIVE_OBSTACLE): (
        "negative obstacle{s}|[part/piece] of the [way/path/floor] is missing|"
        "missing [part of the way/grating/floor grating/floor plate/plate]|"
        "[grating/floor plate] is missing|[hole/gap/opening] in the [floor/ground/way/path/grating]"
    ),
    ("EVENT", None): "{any} obstacle{s}",
    ("EVENT", EventKind.TIME_UP): (
        "time [is up/is over/runs out/has run out/is exceeded/expires/has expired/is out/is used "
        "up/has passed/ends]|"
        "[maximum duration/maximum time/time limit/mission time/allotted time] [is over/is up/is "
        "reached/is exceeded/has passed/expires/has expired/has elapsed]|"
        "[mission/robot/it] runs out of time|time-out|timeout"
    ),
    ("EVENT", EventKind.ALL_CLEAR): (
        "[all-clear/all clear] {signal} [is given/has been given/comes/sounds/]|it is all clear|"
        "danger [is over/is gone/has passed/has been averted]|"
        "alarm [is over/is off/has ended/ends/stops/is cleared/is lifted/is cancelled]|"
        "it is [clear/safe] {again}|area is safe {again}|situation is clear|everything is clear"
    ),
    ("EVENT", EventKind.BATTERY_CHARGED): (
        "[battery/it] [is/has been] {fully} [charged/recharged/full] {again}|"
        "{fully} [charged/recharged] {again}|[charging/recharging] is [finished/complete/done]|"
        "battery [charged/full]|battery has [charged/recharged]"
    ),
    ("EVENT", EventKind.CONNECTION_RESTORED): (
        "[connection/communication/contact/signal/link/network/radio contact/it/connection to "
        "the control room] [is/has been] [restored/re-established/reestablished/back/back again/"
        "up again/there again/available again/established again/reconnected]|"
        "[connection/communication/signal] [returns/comes back/has returned/is back up/works "
        "again]|"
        "[connection/communication] restored|reconnected"
    ),
}

MANNERS: Phrases = {
    ("TO", None): "to|into",
    ("IN", None): "in|inside",
    ("AT", None): "[at/driving at/moving at]|[at/with] [speed/velocity] of",
    ("ON", None): "on|onto",
    ("FOR", None): "for {the next}|over a period of|for a period of|for the duration of",
    ("PERSON", None): "operator|person|supervisor|control room|somebody|someone",
    ("EVERY", None): "every|once every|at intervals of|in intervals of|at an interval of",
    ("TIMES", Figure(1.0)): "once|a single time",
    ("TIMES", Figure(2.0)): "twice",
    ("MORE", Figure(1.0)): (
        "again|once [more/again]|one more time|one more round|another [time/round]|"
        "a [second/third/further] time|anew"
    ),
    ("TIMES", Figure(3.0)): "thrice",
    ("MORE_WORD", None): "more|further|additional|extra|other",
    (
        "TIME_WORD",
        None,
    ): "time{s}|times [over/in a row/running]|round{s}|cycle{s}|lap{s}|attempt{s}|tries",
    ("WITHIN", None): (
        "within [the first/the next/]|in [at most/less than/under/no more than]|"
        "[in/during/inside] the first"
    ),
    ("MEASURING", None): "measuring of|measurement of",
    ("EVERYTHING", None): (
        "everything|[all/all of] steps|"
        "[whole/entire] [thing/mission/round/protocol/list/procedure/tour/sequence]|"
        "all of [this/it]|all this|every step|it all|whole lot"
    ),
    ("BY", None): "by|with",
    ("BEFORE", None): "before|prior to|ahead of|earlier than",
    ("AFTER", None): "after|behind|right after|immediately after|just after|later than",
    ("LATEST", None): "[not/no] later than {at}|at the latest [after/by/at/in]|at the latest",
    ("SINCE_START", None): (
        "[after/of/from/since/past] [start/departure/mission start/mission's start/beginning of "
        "the mission/start of the mission/beginning/start of the round]|"
        "after [it/mission/robot] [starts/started/has started/begins]|into the [mission/round]|"
        "after [leaving/setting out]"
    ),
    ("IF_TIME", None): (
        "{only} if there is {still} {enough} time [left/remaining/for it/for that/]|"
        "if there's {still} {enough} time {left}|if there is any time left|time permitting|"
        "as time permits|if {enough} time [allows/permits/is left/remains/suffices/is available]|"
        "if [we/you/it] {still} [have/has] {enough} time {left}|optional{ly}|only if there's time"
    ),
    ("PRIORITY", None): "with priority|priority",
    ("RANKED", 3): (
        "with high priority|high priority|with priority high|priority high|with top priority|"
        "top priority|with the highest priority"
    ),
    ("RANKED", 2): (
        "with medium priority|medium priority|with priority medium|priority medium|"
        "with normal priority|normal priority"
    ),
    ("RANKED", 1): (
        "with low priority|low priority|with priority low|priority low|with the lowest priority"
    ),
    ("BY_IMPORTANCE", None): (
        "by importance|in order of importance|by priority|in order of priority|"
        "most important first|most important one first|most important ones first"
    ),
    ("LEAVE_OUT", None): (
        "leave out what does not fit|leave out whatever does not fit|skip what does not fit|"
        "leave out what doesn't fit|what does not fit may be left out|"
        "what does not fit is left out|as many as fit|do as many as fit|check as many as fit|"
        "as many of them as fit"
    ),
    ("ANY_ORDER", None): (
        "in [any/whatever/whichever/any convenient/free/best/arbitrary/shortest/fastest/optimal] "
        "[order/sequence]|in no particular order|in order that [suits/is] best|"
        "in [whatever/whichever] order [you like/suits/suits you/it likes/works best]|"
        "in [whatever/whichever] order is [best/quickest/fastest/shortest]|regardless of the order"
    ),
    ("ORDER_FREE", None): (
        "order [is free/is arbitrary/is not important/is not fixed/is irrelevant/does not matter/"
        "doesn't matter/isn't important/is up to you/is up to the robot]|you may choose the order|"
        "[they/checkpoints/steps] [may/can] be [visited/done/read/checked] in any order"
    ),
    ("THIS_ORDER", None): (
        "in [this/precise/this precise/given/exact/exactly this/this exact/stated/same/listed/"
        "this very/written] order|"
        "in the order [given/listed/stated/shown/written]|one after another in this order"
    ),
    ("TOTAL", None): "in total|in all|altogether|all in all|overall|total|in sum",
    ("MODE", Mode.AUTONOMOUS): "autonomous{ly}",
    ("MODE", Mode.SUPERVISORY): "supervisory",
    ("UPTO", None): "through|thru",
    ("FINISHING", None): "[finishing/completing] [the/its/that] round",
    ("STOPPING", None): "stopping at once|stopping immediately",
    ("ENDLESS", None): (
        "endlessly|forever|for ever|without [end/limit]|indefinitely|infinitely|non-stop|"
        "until further notice"
    ),
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
    ("EARLIEST", None): (
        "not before|[no/not] [earlier/sooner] than {after}|at the earliest [after/at/in/]|"
        "only after"
    ),
    ("UNIT_S", 86400.0): "day{s}",
    ("UNIT_S", 3600.0): "h|hour{s}|hrs|hr|hrs .|hr .",
    ("UNIT_S", 2700.0): "three-quarter hour",
    ("UNIT_S", 1800.0): "half-hour{s}",
    ("UNIT_S", 900.0): "quarter of an hour|quarters of an hour|quarter-hour{s}|quarter hour{s}",
    ("UNIT_S", 60.0): "min|mins|min .|mins .|minute{s}|'",
    ("UNIT_S", 1.0): "s|sec|secs|sec .|secs .|seconds",
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
    ("UNIT", "psi"): "psi|pounds per square inch",
    ("UNIT", "Pa"): "pa|pascal{s}",
    ("UNIT", "hPa"): "hpa|hectopascal{s}",
    ("UNIT", "kPa"): "kpa|kilopascal{s}",
    ("UNIT", "MPa"): "mpa|megapascal{s}",
    ("UNIT", "atm"): "atm|atmospheres",
    ("UNIT", "%"): "[%/percent/per cent/pct] [full/of the scale/]",
    ("UNIT", "deg"): "°|deg|degree{s}",
    ("UNIT", "rad"): "radian{s}",
    ("UNIT", "degC"): "° c|[degree/degrees] [celsius/c/centigrade]|deg c|celsius",
    ("UNIT", "degF"): "° f|degree{s} fahrenheit|deg f",
    ("UNIT", "mm"): "mm|millimetre{s}|millimeter{s}",
    ("UNIT", "cm"): "cm|centimetre{s}|centimeter{s}",
    ("UNIT", "m"): "m|metre{s}|meter{s}",
    ("UNIT", "l"): "litre{s}|liter{s}",
    ("UNIT", "kg"): "kg|kilogram{s}",
    ("HALF", None): "half",
}

JOINTS: Phrases = {
    ("JOINT", "and"): "and|plus|as well as|+",
    ("JOINT", "but"): "but",
    ("JOINT", "or"): "or",
}

PARTS = (NOTHING, VERBS, NOUNS, CONDITIONS, MANNERS, FIGURES, JOINTS)
