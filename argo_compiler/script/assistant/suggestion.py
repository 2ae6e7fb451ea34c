"""Suggestions of an assistant for lines of a script."""

from argo_compiler.base.model import Model


class SuggestedSentence(Model):
    """A sentence, and the words of the line that it stands for."""

    words: str
    sentence: str


class LineSuggestion(Model):
    """Answer of an assistant for a line of a script, which is found again by its text."""

    text: str
    """of the line, with single blanks"""
    sentences: tuple[SuggestedSentence, ...] = ()
    """none: the assistant was asked, and suggests nothing"""
    occurrence: int = 1
    """which of the lines with this text it is, from 1"""
    occurrences: int = 1
    """how many lines had this text"""
