"""Codes of diagnostics about mission scripts."""

from argo_compiler.diagnostics.codes.code import error, note, warning

SCRIPT = {
    "script.after-docking": error(
        "A step comes after the robot has returned to its docking station.",
        "Move the return to the end.",
    ),
    "script.after-done": error(
        "A line comes after `Done!`, the end of the protocol.",
        "Move it up, or remove the earlier `Done!`.",
    ),
    "script.always-holds": warning(
        "A condition is true for every measured value.",
        "Write `and` for `or` if a range is meant, or correct its bounds.",
    ),
    "script.ambiguous-all": error(
        "A word such as `everything` can mean all steps so far, or all checkpoints of the site.",
        "Write `repeat everything once more`, or `check all checkpoints`.",
    ),
    "script.ambiguous-and-or": error(
        "A list contains both `and` and `or`, and can be read in two ways.",
        "Write it as one of the two readings in the message.",
    ),
    "script.ambiguous-case": error(
        "An order after a condition can belong to the condition, or be unconditional.",
        "Write `, then ...` if it belongs to the condition, else a sentence of its own.",
    ),
    "script.ambiguous-cell": error(
        "A cell of a table can be read in two ways.", "Write it as the hint shows."
    ),
    "script.ambiguous-checkpoint": error(
        "Several checkpoints have the name that the script uses.", "Name it by its number."
    ),
    "script.ambiguous-cut": error(
        "A word cut by text recognition can be read in more than one way.",
        "Write the word or words without the tab.",
    ),
    "script.ambiguous-demand": error(
        "A requirement can apply to an earlier measurement, or ask for another one.",
        "Write it where the checkpoint is measured.",
    ),
    "script.ambiguous-duration": error(
        "A duration can be read in two ways, or apply to each part or to all parts together.",
        "Write its units, as in `10 min 30 s`, or a separate sentence that names the part.",
    ),
    "script.ambiguous-edit": error(
        "An edit fits more than one step of the mission.", "Name one of the steps."
    ),
    "script.ambiguous-event": error(
        "An obstacle may be a thing on the path, or a hole in the path.",
        "Write `a positive obstacle` or `a negative obstacle`.",
    ),
    "script.ambiguous-exception": error(
        "The words after an exception can be part of the exception, or be done as well.",
        "Write the exception at the end, or two sentences.",
    ),
    "script.ambiguous-floor": error(
        "What is meant by a floor, or by a number after it, is not clear.",
        "Write `floors 1 and 2`, and the floor behind each thing that is read there.",
    ),
    "script.ambiguous-manner": error(
        "A clause can apply only to the last of several orders, or to each of them.",
        "Write it after a list of the things it applies to, or write two sentences.",
    ),
    "script.ambiguous-measure": error(
        "A reading is requested right after the same measurement: the same one, or another one.",
        "Leave it out, or write `check it again`.",
    ),
    "script.ambiguous-number": error(
        "A number can be read in two ways, such as `1.200`.", "Write it as the hint shows."
    ),
    "script.ambiguous-or": error(
        "Checkpoints to be measured are joined by `or`.",
        "Write `and` for all of them, or name one.",
    ),
    "script.ambiguous-order": error(
        "`First` or `last` with a kind of checkpoint can be a step, or the order of other lines.",
        "Write `check all ...` as a step, or write the steps in the right order.",
    ),
    "script.ambiguous-otherwise": error(
        "`Otherwise` can belong to the last of several conditions or to all of them.",
        "Write `otherwise, if ...`, or each condition in a step of its own.",
    ),
    "script.ambiguous-place": error(
        "The names of two places of the site differ only in capitals or small words, or a place "
        "may be where an action takes place or where the robot goes.",
        "Write the coordinates of the right place, or the sentence as the hint shows.",
    ),
    "script.ambiguous-priority": error(
        "It is unclear whether priority 1 is the highest or the lowest.",
        "Write `high`, `medium` or `low`, or state the number of the highest one over the column.",
    ),
    "script.ambiguous-pronoun": error(
        "A word such as `it` can mean several checkpoints.", "Name the checkpoint."
    ),
    "script.ambiguous-quote": error(
        "Some orders are in quoted lines of a letter that is answered, others are not.",
        "Remove the lines that are not to be done, and the `>` before those that are.",
    ),
    "script.ambiguous-remark": error(
        "A remark may withdraw an order, or state when or how it is done.",
        "Write it as an order, or leave the remark out.",
    ),
    "script.ambiguous-repeat": error(
        "The number of repetitions can be read in two ways.",
        "Write it as one of the two readings in the message.",
    ),
    "script.ambiguous-step": error(
        "More than one step has the given number.",
        "Renumber the steps, or name the task.",
    ),
    "script.ambiguous-title": error(
        "A line over steps may be a title or an order, or state that they are not to be done.",
        "Write `Designation: ...` for a title, a numbered step for an order, and leave steps out "
        "that are not to be done.",
    ),
    "script.ambiguous-word": error(
        "A small word in this position may change the meaning.", "Write it as the hint shows."
    ),
    "script.area-choice": error(
        "The script does not fix the starting area; it is chosen during preparation.",
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
        "A battery condition does not state a charge in % that the battery drops below.",
        "Write, say, `if the battery drops below 30 %`.",
    ),
    "script.bound-task": error(
        "An edit moves, replaces or removes a task that belongs to a condition.",
        "Change the line that asks for it.",
    ),
    "script.checkpoint-mismatch": error(
        "The checkpoint with this number has another name on the site.",
        "Correct the number or the name.",
    ),
    "script.condition": error(
        "Missions do not have a condition of this kind.",
        "Compare one checkpoint: less than, greater than, or between two values.",
    ),
    "script.coordinates": error("Coordinates are two or three numbers.", "Write `(12.5, 3, 2.5)`."),
    "script.decided": note(
        "A person has confirmed what is proposed for a line, or has said it in other words.",
        "No action is needed; undo the decision if it is wrong.",
    ),
    "script.decision-unused": warning(
        "The script has changed, and a decision about one of its lines has no effect any more.",
        "Import the script again to forget the decision, or decide anew.",
    ),
    "script.deep-rounds": error(
        "Too many repetitions are nested.",
        "Repeat the steps more often in one of them.",
    ),
    "script.dock-assumed": warning(
        "The script does not name the docking station; one was assumed.",
        "Name its starting area.",
    ),
    "script.document": warning(
        "Something in a document is not read: a hidden column or sheet, struck-through words, a "
        "deletion; or words of a tracked change are read.",
        "Show it, or accept or reject the change, in the document's program if it is meant.",
    ),
    "script.duration": error(
        "A duration is zero, or its units are mixed up.",
        "Write hours before minutes before seconds, each once: `1 h 30 min`.",
    ),
    "script.empty": error(
        "The script is empty.", "Name a file with a mission sheet or a mission protocol."
    ),
    "script.empty-name": error(
        "The quotation marks before an order are empty.",
        "Write a name between them, or remove them.",
    ),
    "script.empty-floor": warning(
        "One of several floors has no checkpoint of the requested kind.",
        "Leave the floor out, or name another one.",
    ),
    "script.empty-range": error(
        "A range of checkpoints has its numbers in the wrong order.",
        "Write the lower number first.",
    ),
    "script.empty-step": error(
        "The mission has to continue at a step that plans nothing.",
        "Name a step that measures or drives.",
    ),
    "script.endless-patrol": error(
        "A patrol would never end.", "State for how long or how often it is driven."
    ),
    "script.endless-repeat": error(
        "A repetition would never end.",
        "State for how long or how often, or `endlessly` if a condition ends it.",
    ),
    "script.fact": error(
        "A time limit for the return needs a docking station, not another place.",
        "Name the starting area.",
    ),
    "script.failure": error(
        "A mission can't do this after a failure.",
        "Use one of the forms in the hint.",
    ),
    "script.field": error(
        "A field of the header has an invalid value.",
        "Write one of the values in the hint.",
    ),
    "script.healed": warning(
        "A word that text recognition had split was joined again.",
        "Check that it was read correctly.",
    ),
    "script.height": error(
        "The height of a position is missing, or contradicts its floor.",
        "State the floor or the height.",
    ),
    "script.instead": error(
        "The script does not state what an `instead` replaces.",
        "Write it after `otherwise`, or after the orders for the failure of a task.",
    ),
    "script.listed-twice": warning(
        "A list names the same checkpoint more than once.",
        "Name it once if it is to be done once.",
    ),
    "script.long-line": error("A line or cell is too long for a script.", "Shorten it."),
    "script.long-wait": warning(
        "A wait takes as long as the maximum duration of the mission, or longer.",
        "Wait for a shorter time, or give the mission more time.",
    ),
    "script.needless-exception": warning(
        "An exception names a checkpoint that is not one of the others anyway.",
        "Name the right checkpoint, or remove the exception.",
    ),
    "script.no-area": error(
        "The sheet names no starting area.",
        "Name one in the sheet, or choose the areas to start and to end in.",
    ),
    "script.no-checkpoint": error(
        "An exception leaves no checkpoint.", "Name the remaining checkpoints."
    ),
    "script.comment": note(
        "A line that is labelled as a hint, a note or a remark has no effect on the mission.",
        "No action is needed; if it is an order, write it without the label.",
    ),
    "script.no-effect": warning(
        "Words such as a greeting or a remark have no effect on the mission.",
        "If they are an order, write it in other words; else remove them, or set the line aside.",
    ),
    "script.no-patrol": error(
        "A floor has no three places that the robot can drive between.",
        "Name a checkpoint or a place of the floor, or check the site.",
    ),
    "script.no-start": error(
        "The protocol does not state where the robot starts.", "Set a starting point."
    ),
    "script.no-task": error(
        "A line refers to the task before it, but there is none.",
        "Write it after the task that it belongs to.",
    ),
    "script.not-measured": warning(
        "A condition compares a checkpoint that is not measured before it.",
        "Measure it before, unless its value comes from elsewhere.",
    ),
    "script.no-time-limit": warning(
        "An order applies if there is time, but the mission has no time limit.",
        "Give the mission a maximum duration.",
    ),
    "script.not-first": error(
        "An order has to be done first, but another one comes before it.",
        "Write the first order above the others.",
    ),
    "script.not-last": error(
        "An order has to be done at the end, but others come after it.",
        "Write the last order below the others.",
    ),
    "script.not-neighbours": error(
        "A wait is put between two tasks that do not come one right after the other.",
        "Write the wait in a line of its own, between the lines of the two.",
    ),
    "script.not-planned": error(
        "An edit names a step that is not in the mission at this point.",
        "Add the step before the edit, or correct the name.",
    ),
    "script.not-understood": error(
        "Argo does not understand a line.", "Write a line such as the one in the hint."
    ),
    "script.nothing-to-do": error(
        "The script contains no order.", "Add a step, such as a checkpoint to read."
    ),
    "script.number": error("A number is too large.", "Correct the number."),
    "script.once-more": warning(
        "`Repeat once` is read as: do the steps once more.",
        "Write `once more`, or `once in total`.",
    ),
    "script.one-checkpoint": error(
        "Several checkpoints are named where only one is possible.", "Name one of them."
    ),
    "script.one-name": error(
        "One name is given to several tasks.", "Give each task its own line and name."
    ),
    "script.order-taken": note(
        "Tasks that do not fit are left out, and no order is stated: it is assumed to be free.",
        "Write `Order: precise` if it is not.",
    ),
    "script.other-site": warning(
        "The script names another site than the one that it is imported for.",
        "Check the chosen site, or correct the script.",
    ),
    "script.otherwise": error(
        "An `otherwise` follows no condition, or leads nowhere.",
        "Write it after the condition that it belongs to.",
    ),
    "script.overlap": error(
        "Two repetitions overlap in some of their steps.",
        "Nest one completely in the other, or separate them.",
    ),
    "script.partly-free": error(
        "Only some of the tasks may be done in any order.",
        "State that the order is free, and which tasks have to come before others.",
    ),
    "script.pause": error(
        "A pause is requested between rounds that have conditions, or no known end.",
        "Write all tasks and waits of all rounds one after the other.",
    ),
    "script.precedence": error(
        "The written order breaks the rule that a task comes before another. A warning if the "
        "order is free.",
        "Move a task, or remove the rule.",
    ),
    "script.priority-taken": note(
        "A priority in words is converted to a number.",
        "Write `with priority 7` for another one.",
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
        "A reaction has an unknown response, or two responses.",
        "Write one of the responses in the hint.",
    ),
    "script.remark": warning(
        "A remark contains an order, which is not planned.",
        "If it is an order, remove the word that makes it a remark.",
    ),
    "script.question": error(
        "A sentence is a question, and may not be an order.",
        "Write it as an order, or remove it; in a draft, choose one of the two.",
    ),
    "script.repeated-field": error("A field or title occurs twice.", "Leave one of the two out."),
    "script.repeated-limit": error(
        "A repetition is limited twice in the same way.", "Leave one out."
    ),
    "script.repeated-name": error(
        "More than one task has the same name.", "Give each task a name of its own."
    ),
    "script.repeated-there": warning(
        "Steps are repeated at their own position, not at the line with the repetition.",
        "Write `repeat step 2 again` to do them once more at that line.",
    ),
    "script.respelled": warning(
        "A misspelt word was read as a known one.", "Check that it was read correctly."
    ),
    "script.rounds": error("A patrol has no rounds.", "Give it at least one round."),
    "script.route": error(
        "An order is not possible here, or can't depend on a condition.",
        "Write it as a step of its own; only some orders, such as to go to a step, to drive or to "
        "measure, can depend on a condition.",
    ),
    "script.second-reaction": error(
        "Two lines define the reaction to the same event.", "Leave one of the two out."
    ),
    "script.second-route": error(
        "If no condition is true, the mission has two next steps.",
        "Leave one out, or give it a condition.",
    ),
    "script.second-start": error(
        "The protocol sets a second starting point.", "Keep one of them, or edit the first."
    ),
    "script.self-move": error(
        "A step can't be placed before or after itself.", "Name another step."
    ),
    "script.row": error(
        "It is not decided what a row of a sheet asks for.",
        "Confirm what is proposed for it, or say it as a sentence.",
    ),
    "script.other-range": warning(
        "A normal range, position or quantity in the script is not the site's; the site's counts.",
        "Correct the script, or the site.",
    ),
    "script.set-aside": warning(
        "A line has no effect, as it names nothing that a mission has.",
        "Write it as a step if the robot has to do something; otherwise no action is needed.",
    ),
    "script.set-aside-by-hand": note(
        "A person has decided that a line has no effect.",
        "No action is needed; undo the decision if the line has to count.",
    ),
    "script.several-floors": error(
        "The robot is sent to several floors in one order.", "Write an order for each of them."
    ),
    "script.several-places": error(
        "Two places are named where only one is possible.", "Leave one of the two out."
    ),
    "script.speed": error("A speed is zero or not a number.", "Write, say, `at 0.3 m/s`."),
    "script.speed-shared": warning(
        "A speed applies to every drive to a task, not only to the one in the script.",
        "Add a waypoint in between if the other drives are to have another speed.",
    ),
    "script.speed-unused": warning(
        "A speed is given for the drive from a task, but the mission ends with this task.",
        "Remove the speed, or give it to the task that the drive leads to.",
    ),
    "script.spared": error(
        "The script asks for a checkpoint, and elsewhere states that it is not to be checked.",
        "Remove one of the two statements.",
    ),
    "script.start": error(
        "A mission starts at a place, not on a floor.", "Name a starting area or a place."
    ),
    "script.step-number": warning(
        "The numbers of the steps are not consecutive.",
        "Check whether a line is missing or in the wrong position.",
    ),
    "script.step-range": error(
        "A range of steps is reversed, or several steps are named where only one is possible.",
        "Write the earlier step first, or name one step.",
    ),
    "script.stray-clause": error(
        "A part of the line belongs to no order.", "Write it after the order that it belongs to."
    ),
    "script.title": note(
        "A line over the script is read as its title, which is the mission's designation.",
        "If it is an order, write it as a sentence; otherwise no action is needed.",
    ),
    "script.too-late": error(
        "An order for the case of a missed time limit does not follow a task with a time limit.",
        "Write it after such a task.",
    ),
    "script.too-long": error("The script has too many lines.", "Divide the mission."),
    "script.too-many-errors": error(
        "The rest of the script is not checked, because there are too many errors.",
        "Correct the reported errors, and check that it is the right file.",
    ),
    "script.two-speeds": error("Two speeds are given for one drive.", "Leave one of them out."),
    "script.unclear-cut": warning(
        "Argo can't decide whether a tab splits a word; it was read as two words.",
        "Write the words without the tab.",
    ),
    "script.unfinished": error("The line is incomplete.", "Complete it as in the hint."),
    "script.unit": error(
        "A value has another unit than the checkpoint.", "Write it in the checkpoint's unit."
    ),
    "script.unknown-area": error(
        "The site has no such starting area.", "Use one of the site's starting areas."
    ),
    "script.unknown-checkpoint": error(
        "The site has no such checkpoint.", "Use the number or name of an existing one."
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
        "No step or task has this number or name.", "Use one of those in the hint."
    ),
    "script.unreadable": error(
        "The script's file can't be read, or is not text.", "Check the path, and save it as UTF-8."
    ),
    "script.unwritable": error(
        "A part of the mission can't be expressed in a script.",
        "Keep the mission as JSON, or change the named part.",
    ),
    "script.visit": error(
        "The robot is sent to a checkpoint, but the script does not state what to do there.",
        "Write `check checkpoint 4`.",
    ),
    "script.wait": error(
        "A wait has no duration, event or condition, or too many of them.",
        "Write `wait 90 s`, `wait until #1 is below 3` or `wait for the all-clear`.",
    ),
    "script.which-checkpoint": error(
        "A condition does not name its checkpoint.", "Name the checkpoint."
    ),
    "script.which-place": error("The place that `there` refers to is unknown.", "Name the floor."),
}
