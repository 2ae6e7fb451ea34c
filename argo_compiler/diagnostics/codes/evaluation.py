"""Codes of diagnostics about files of evaluations."""

from argo_compiler.diagnostics.codes.code import error

EVALUATION = {
    "evaluation.duplicate-key": error(
        "A mapping in the file of an evaluation has the same key twice.", "Remove one of the two."
    ),
    "evaluation.not-yaml": error(
        "The file of an evaluation is not YAML.", "Correct the file at the mark."
    ),
    "evaluation.wrong-field": error(
        "A field of the evaluation is unknown, missing, or has an invalid value.",
        "Correct the field; the page `evaluating` of the documentation lists them.",
    ),
}
