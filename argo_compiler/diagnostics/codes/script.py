"""The codes of diagnostics about mission scripts."""

from argo_compiler.diagnostics.codes.code import error, note, warning

SCRIPT = {
    "script.after-docking": error(
        "A step comes after the robot has returned to its docking station.",
        "Move the return to the end.",
    ),
    "script.after-done": error(
        "A line comes after the protocol has said that it is done.",
        "Move it up, or remove the earlier `Done!`.",
    ),
    "script.always-holds": warning(
        "A condition holds for every value that is measured.",
        "Write `and` for `or` if a range is meant, or correct its bounds.",
    ),
    "script.ambiguous-all": error(
        "All of it can mean what was done so far, or all checkpoints of the site.",
        "Write `repeat everything once more`, or `check all checkpoints`.",
    ),
    "script.ambiguous-and-or": error(
        "`And` and `or` stand in one list, which can be read in two ways.",
        "Write it as one of the two readings in the message.",
    ),
    "script.ambiguous-case": error(
        "What stands behind a case can be meant for this case only, or for any.",
        "Write `, then ...` for the first, a sentence of its own for the second.",
    ),
    "script.ambiguous-cell": error(
        "A cell of a table can be read in two ways.", "Write it as the hint shows."
    ),
    "script.ambiguous-checkpoint": error(
        "Several checkpoints have the name that the script uses.", "Name it by its number."
    ),
    "script.ambiguous-cut": error(
        "A word cut by text recognition can be read in more than one way.",
        "Write it without the tab as it is meant.",
    ),
    "script.ambiguous-demand": error(
        "A demand can be one on what is measured before, or ask for it once more.",
        "Say it where the checkpoint is measured.",
    ),
    "script.ambiguous-duration": error(
        "A duration can be read in two ways, or be that of each or of all together.",
        "Write its units, as in `10 min 30 s`, or what it is said of in a sentence of its own.",
    ),
    "script.ambiguous-edit": error(
        "An edit fits more than one step of the plan.", "Say which of them is meant."
    ),
    "script.ambiguous-event": error(
        "An obstacle may stand in the way, or be a part of the way that is missing.",
        "Write `a positive obstacle` or `a negative obstacle`.",
    ),
    "script.ambiguous-exception": error(
        "What stands behind an exception can be left out as well, or be done as well.",
        "Write what is left out at the end, or a sentence for each.",
    ),
    "script.ambiguous-floor": error(
        "A number behind a floor can be another floor or something else.",
        "Write `floors 1 and 2`, or name what else is meant.",
    ),
    "script.ambiguous-manner": error(
        "A clause can be meant for the last of several orders only, or for each of them.",
        "Write it behind a list of what it is said of, or in two sentences.",
    ),
    "script.ambiguous-measure": error(
        "What was just measured is to be read, which may be meant as the same or as once more.",
        "Leave it out, or write `check it again`.",
    ),
    "script.ambiguous-number": error(
        "A number can be read in two ways, such as `1.200`.", "Write it as the hint shows."
    ),
    "script.ambiguous-or": error(
        "Checkpoints that are to be measured are joined by `or`.",
        "Write `and` for all of them, or name the one that is meant.",
    ),
    "script.ambiguous-order": error(
        "A kind is said to come first or last; that may be a step, or the order of the others.",
        "Write `check all ...` as a step, or the steps in the order that is meant.",
    ),
    "script.ambiguous-otherwise": error(
        "`Otherwise` can belong to the last of several conditions or to all of them.",
        "Write `otherwise, if ...`, or each condition in a step of its own.",
    ),
    "script.ambiguous-place": error(
        "The names of two places of the site differ in capitals or small words only, or a place "
        "may be where something is done or where the robot goes to.",
        "Write the coordinates of the one that is meant, or the sentence as the hint shows.",
    ),
    "script.ambiguous-priority": error(
        "Numbers of priorities can be counted from the most important one, or from the least.",
        "Write `high`, `medium` or `low`, or over a table's column which number is the highest.",
    ),
    "script.ambiguous-pronoun": error(
        "A word such as `it` can mean several checkpoints.", "Name the one."
    ),
    "script.ambiguous-quote": error(
        "Some orders stand in lines of a letter that is answered, others do not.",
        "Leave out those that are not to be done, and `>` before those that are.",
    ),
    "script.ambiguous-remark": error(
        "What looks like a remark may take something back, or say when or how it is done.",
        "Write the sentence as it is meant, or leave the remark out.",
    ),
    "script.ambiguous-repeat": error(
        "How often something is done can be read in two ways.",
        "Write it as one of the two readings in the message.",
    ),
    "script.ambiguous-step": error(
        "More than one step has the number that is named.",
        "Number the steps anew, or name the task.",
    ),
    "script.ambiguous-title": error(
        "A line over steps may be their title or an order, or say that they are not to be done.",
        "Write `Designation: ...` for a title, a numbered step for an order, and leave steps out "
        "that are not to be done.",
    ),
    "script.ambiguous-word": error(
        "A small word may change what is meant where it stands.", "Write it as the hint shows."
    ),
    "script.area-choice": error(
        "The script leaves the starting area to be chosen during preparation.",
        "Choose the areas to start and to end in.",
    ),
    "script.area-conflict": error(
        "Two statements, or a statement and an option, choose different starting areas.",
        "Leave one of them out.",
    ),
    "script.area-not-offered": error(
        "The option chooses a starting area that the script does not offer.",
        "Choose one that the script names.",
    ),
    "script.battery": error(
        "A level of the battery is no share of its charge, or not one that it drops below.",
        "Write, say, `if the battery drops below 30 %`.",
    ),
    "script.bound-task": error(
        "A task that belongs to a condition is to be moved, replaced or taken out.",
        "Change the line that asks for it.",
    ),
    "script.checkpoint-mismatch": error(
        "The checkpoint with this number has another name on the site.",
        "Correct the number or the name.",
    ),
    "script.condition": error(
        "A condition is asked for that missions do not have.",
        "Compare one checkpoint: less than, greater than, or between two values.",
    ),
    "script.coordinates": error("Coordinates are two or three numbers.", "Write `(12.5, 3, 2.5)`."),
    "script.deep-rounds": error(
        "Too many repetitions lie in one another.",
        "Repeat the steps more often in one of them.",
    ),
    "script.dock-assumed": warning(
        "The script does not say which docking station, and one was assumed.",
        "Name its starting area.",
    ),
    "script.duration": error(
        "A duration is zero, or its units are mixed up.",
        "Write hours before minutes before seconds, each once: `1 h 30 min`.",
    ),
    "script.empty": error(
        "The script is empty.", "Name a file with a mission sheet or a mission protocol."
    ),
    "script.empty-name": error(
        "The quotation marks in front of a command have nothing between them.",
        "Write a name there, or leave them out.",
    ),
    "script.empty-floor": warning(
        "On one of several floors there is nothing of the kind that is to be done there.",
        "Leave the floor out, or name another one.",
    ),
    "script.empty-range": error(
        "A range of checkpoints has its numbers the wrong way round.",
        "Write the lower number first.",
    ),
    "script.empty-step": error(
        "The mission is to go on at a step that plans nothing.",
        "Name a step that measures or drives.",
    ),
    "script.endless-patrol": error(
        "A patrol would never end.", "Say for how long or how often it is driven."
    ),
    "script.endless-repeat": error(
        "A repetition would never end.",
        "Say for how long or how often, or `endlessly` where a condition leaves it.",
    ),
    "script.fact": error(
        "A mission ends in a docking station by a certain time, not at a place.",
        "Name the starting area.",
    ),
    "script.failure": error(
        "What is to happen after a failure is not what a mission can do then.",
        "Use one of the forms in the hint.",
    ),
    "script.field": error(
        "A field of the header has a value that it can't have.",
        "Write one of those that the hint names.",
    ),
    "script.healed": warning(
        "A word that text recognition had cut was put together again.",
        "Check that it is read as it is meant.",
    ),
    "script.height": error(
        "The height of a place is missing, or contradicts its floor.",
        "Say the floor or the height that is meant.",
    ),
    "script.instead": error(
        "Something is to be done instead of something else that is not said.",
        "Write it behind `otherwise`, or behind what is done if a task fails.",
    ),
    "script.listed-twice": warning(
        "A list names the same checkpoint more than once.",
        "Leave it out if it is to be done once.",
    ),
    "script.long-line": error("A line or cell is too long to be a script's.", "Shorten it."),
    "script.long-wait": warning(
        "A wait takes as long as the whole mission may take, or longer.",
        "Wait for a shorter time, or give the mission more.",
    ),
    "script.needless-exception": warning(
        "What is left out of some checkpoints is none of them anyway.",
        "Name the one that is meant, or leave the exception away.",
    ),
    "script.no-area": error(
        "The sheet names no starting area.",
        "Name one in the sheet, or choose the areas to start and to end in.",
    ),
    "script.no-checkpoint": error(
        "An exception leaves no checkpoint.", "Name those that are left."
    ),
    "script.no-effect": note(
        "Words such as a title, a greeting or a remark ask for nothing: the mission is the same "
        "without them.",
        "Nothing has to be done; if they are meant to ask for something, say it in other words.",
    ),
    "script.no-start": error(
        "The protocol does not say where the robot starts.", "Set a starting point."
    ),
    "script.no-task": error(
        "Something is said of the task before, and there is none.",
        "Write it behind the task that it belongs to.",
    ),
    "script.not-measured": warning(
        "A condition asks for a checkpoint that is not measured before it.",
        "Measure it before, unless somebody else tells its value.",
    ),
    "script.no-time-limit": warning(
        "Something is done if there is time, and nothing says how much time there is.",
        "Give the mission a maximum duration.",
    ),
    "script.not-first": error(
        "Something is to be done first, and something else stands before it.",
        "Write what is done first above the others.",
    ),
    "script.not-last": error(
        "Something is to be done at the end, and more stands behind it.",
        "Write what is done at the end below the others.",
    ),
    "script.not-planned": error(
        "An edit names what is not in the plan at this point.",
        "Ask for it before the edit, or correct the name.",
    ),
    "script.not-understood": error(
        "A line has no form that Argo knows.", "Write a line such as the one in the hint."
    ),
    "script.nothing-to-do": error(
        "The script asks for nothing to be done.", "Add a step, such as a checkpoint to read."
    ),
    "script.number": error("A number is too large.", "Correct the number."),
    "script.once-more": warning(
        "Steps that are to be repeated once are taken to be done once more.",
        "Write `once more`, or `once in total`.",
    ),
    "script.one-checkpoint": error(
        "Several checkpoints are named where there can be one.", "Name one of them."
    ),
    "script.one-name": error(
        "One name stands before several tasks.", "Give each task a line and a name."
    ),
    "script.order-taken": note(
        "What does not fit is left out, and nothing is said of the order: it is taken to be free.",
        "Write `Order: precise` if it is not.",
    ),
    "script.other-site": warning(
        "The script says that it is for another site than the one that it is read with.",
        "Check the chosen site, or the script's.",
    ),
    "script.otherwise": error(
        "What is said for all other cases stands behind no condition, or leads nowhere.",
        "Write it behind the condition whose other case it is.",
    ),
    "script.overlap": error(
        "Two repetitions have some of their steps in common.",
        "Let one lie in the other as a whole, or separate them.",
    ),
    "script.partly-free": error(
        "Only some of the tasks are to be done in any order.",
        "Say that the order is free, and what has to come before what.",
    ),
    "script.pause": error(
        "A pause is asked for between rounds that have conditions, or no known end.",
        "Write the tasks and the waits out as often as they are done.",
    ),
    "script.precedence": error(
        "The order that is written does not keep to what has to come before what. A warning where "
        "the order is free.",
        "Move a task, or take the requirement back.",
    ),
    "script.priority-taken": note(
        "An importance in words is taken as a number.",
        "Write `with priority 7` if another one is meant.",
    ),
    "script.quantity": warning(
        "The script asks for a quantity that this kind of checkpoint does not show.",
        "Write the quantity in the hint.",
    ),
    "script.quoted-text": error(
        "A quoted text has an escape that does not exist.",
        'Write a backslash as `\\\\` and a quotation mark as `\\"`.',
    ),
    "script.range": error(
        "A range of checkpoints does not go from a number to a number.", "Name each of them."
    ),
    "script.reaction": error(
        "A reaction has a response that does not exist, or two of them.",
        "Write one of those in the hint.",
    ),
    "script.remark": warning(
        "A remark asks for something, and is not planned.",
        "Write it without the word that makes it a remark, if it is an order.",
    ),
    "script.repeated-field": error("A field or title stands twice.", "Leave one of the two out."),
    "script.repeated-limit": error(
        "A repetition is limited twice in the same way.", "Leave one out."
    ),
    "script.repeated-name": error(
        "More than one task has the same name.", "Give each task a name of its own."
    ),
    "script.repeated-there": warning(
        "Steps are repeated where they stand, not at the line that says so.",
        "Write `repeat step 2 again` for doing them at that line once more.",
    ),
    "script.respelled": warning(
        "A misspelt word was taken for one that is known.", "Check that it is read as it is meant."
    ),
    "script.rounds": error("A patrol has no rounds.", "Let it have at least one."),
    "script.route": error(
        "What follows a condition is not what a mission can do in one case only.",
        "Go to a step, drive or measure.",
    ),
    "script.second-reaction": error(
        "Two lines say what to do in the same event.", "Leave one of the two out."
    ),
    "script.second-route": error(
        "Where no condition holds, the mission is to go on in two ways.",
        "Leave one out, or give it a condition.",
    ),
    "script.second-start": error(
        "The protocol sets a second starting point.", "Keep one of them, or edit the first."
    ),
    "script.self-move": error("A step is to stand before or after itself.", "Name another place."),
    "script.several-floors": error(
        "The robot is sent to several floors at a time.", "Write an order for each of them."
    ),
    "script.several-places": error(
        "Two places are named where one is meant.", "Leave one of the two out."
    ),
    "script.speed": error("A speed is zero or no number.", "Write, say, `at 0.3 m/s`."),
    "script.speed-shared": warning(
        "A speed holds for every way that leads to a task, not only for the one that the script "
        "says it of.",
        "Plan a waypoint in between if the other ways are to be driven at another speed.",
    ),
    "script.speed-unused": warning(
        "A task is to be left at a speed, but the mission ends with it.",
        "Give the speed to the task that the way leads to.",
    ),
    "script.spared": error(
        "A checkpoint is asked for, and elsewhere the script says that it is not to be checked.",
        "Leave one of the two out.",
    ),
    "script.start": error(
        "A mission starts at a place, not on a floor.", "Name a starting area or a place."
    ),
    "script.step-number": warning(
        "The numbers of the steps are not one after the other.",
        "Check whether a line is missing or in the wrong place.",
    ),
    "script.step-range": error(
        "Steps are named the wrong way round, or several where one is meant.",
        "Write the earlier one first, or name one.",
    ),
    "script.stray-clause": error(
        "A part of the line belongs to nothing before it.", "Write it behind what it belongs to."
    ),
    "script.title": note(
        "A line over the script is taken for its title, which is the mission's designation.",
        "Write what is to be done as a sentence; nothing else has to be done.",
    ),
    "script.too-late": error(
        "What is done if it is too late follows no task that is due by a certain time.",
        "Write it behind such a task.",
    ),
    "script.too-long": error("The script has too many lines.", "Divide the mission."),
    "script.too-many-errors": error(
        "The rest of the script is not looked at, as too much of it is wrong.",
        "Correct what was found so far, and check that it is the right file.",
    ),
    "script.two-speeds": error("Two speeds are asked for on one way.", "Leave one of them out."),
    "script.unclear-cut": warning(
        "Argo can't tell whether a tab cuts a word; it was read as two words.",
        "Write the words without the tab.",
    ),
    "script.unfinished": error(
        "The line ends before it has said all.", "Complete it as in the hint."
    ),
    "script.unit": error(
        "A value has another unit than the checkpoint.", "Write it in the checkpoint's unit."
    ),
    "script.unknown-area": error(
        "The site has no such starting area.", "Use one of the site's starting areas."
    ),
    "script.unknown-checkpoint": error(
        "The site has no such checkpoint.", "Use the number or name of one that it has."
    ),
    "script.unknown-floor": error("The site has no such floor.", "Use one of the site's floors."),
    "script.unknown-label": error(
        "The sheet has a field with a label that Argo does not know.",
        "Correct the label as in the hint.",
    ),
    "script.unknown-place": error(
        "The site has no such place.", "Use one of the site's places or starting areas."
    ),
    "script.unknown-step": error(
        "There is no step or task of that number or name.", "Name one of those in the hint."
    ),
    "script.unreadable": error(
        "The script's file can't be read, or is no text.", "Check the path, and save it as UTF-8."
    ),
    "script.unwritable": error(
        "A part of the mission can't be said in a script.",
        "Keep the mission as JSON, or change what is named.",
    ),
    "script.visit": error(
        "The robot is sent to a checkpoint, and nothing is said of what to do there.",
        "Write `check checkpoint 4`.",
    ),
    "script.wait": error(
        "A wait does not say how long or for what, or says more than one wait can.",
        "Write `wait 90 s`, `wait until #1 is below 3` or `wait for the all-clear`.",
    ),
    "script.which-checkpoint": error("It is not said which checkpoint is compared.", "Name it."),
    "script.which-place": error("It is not said which place `there` is.", "Name the floor."),
}
