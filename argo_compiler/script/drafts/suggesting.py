"""Lines of a draft that an assistant may be asked about, and its answer as their suggestions."""

from collections.abc import Iterable, Mapping

from argo_compiler.script.assistant.answer import AnswerEntry
from argo_compiler.script.assistant.claims import find_words
from argo_compiler.script.assistant.suggestion import LineSuggestion, SuggestedSentence
from argo_compiler.script.drafts.draft import Draft, DraftLine, LineState, suggestions_of


def lines_to_ask(draft: Draft) -> tuple[DraftLine, ...]:
    """Return the lines that are not understood, and that nobody has decided on or been asked about.

    Lines with several meanings are questions to a person, and not among them.
    """
    return tuple(
        line
        for line in draft.lines
        if line.state is LineState.OPEN and not line.is_question
        if line.suggested is None and line.act is None
    )


def suggestions_from(draft: Draft, entries: Iterable[AnswerEntry]) -> tuple[LineSuggestion, ...]:
    """Return the suggestions of a draft with those of an answer about its open lines.

    An entry about another line, or with words that the line does not have, has no effect, and one
    that is given twice counts once.
    """
    asked = lines_to_ask(draft)
    given: dict[int, list[SuggestedSentence]] = {id(line): [] for line in asked}
    for entry in entries:
        part = SuggestedSentence(words=entry.words, sentence=entry.sentence)
        line = next((one for one in asked if _is_about(entry, one)), None)
        if line is not None and part not in given[id(line)]:
            given[id(line)].append(part)
    return suggestions_of((line.text, _of(line, given)) for line in draft.lines)


def _is_about(entry: AnswerEntry, line: DraftLine) -> bool:
    in_line = line.line <= entry.line <= line.last_line
    return in_line and find_words(line.text, entry.words) is not None


def _of(
    line: DraftLine, given: Mapping[int, list[SuggestedSentence]]
) -> tuple[SuggestedSentence, ...] | None:
    found = given.get(id(line))
    return line.suggested if found is None else tuple(found)
