"""A number with thousands of digits, which Python does not read, gets a message without Python."""

import pytest

from argo_compiler.base.errors import ArgoError
from argo_compiler.files.mission_file import decode_mission
from argo_compiler.files.route_problem_file import parse_route_problem
from argo_compiler.files.yaml_text import load_yaml
from argo_env.evaluation.file import decode_evaluation
from argo_env.faults.loading import decode_faults
from argo_env.run.spec import read_spec
from argo_env.site.site_file import parse_site_spec

NUMBER = "9" * 6000
READERS = {
    "yaml": lambda: load_yaml(f"a: {NUMBER}", "file"),
    "tagged yaml": lambda: load_yaml("a: !!int seven", "file"),
    "version": lambda: decode_mission(f'{{"version": {NUMBER}}}'.encode(), "file"),
    "mission": lambda: decode_mission(f'{{"version": 4, "tasks": [{NUMBER}]}}'.encode(), "file"),
    "route problem": lambda: parse_route_problem(f'{{"version": {NUMBER}}}', "file"),
    "spec": lambda: read_spec(f'{{"mission": {{}}, "seed": {NUMBER}}}'.encode(), "file"),
    "evaluation": lambda: decode_evaluation(f"missions: [m]\nseeds: {NUMBER}".encode(), "file"),
    "faults": lambda: decode_faults(f"faults: [{{charge: {NUMBER}}}]".encode(), "file"),
    "site": lambda: parse_site_spec(f"name: {NUMBER}", "file"),
}


@pytest.mark.parametrize("reader", READERS)
def test_a_number_with_thousands_of_digits_is_named(reader):
    with pytest.raises(ArgoError) as refused:
        READERS[reader]()
    said = str(refused.value)
    assert said.startswith("file")
    assert "a number with thousands of digits" in said
    assert "sys." not in said
    assert "int()" not in said


def test_messages_have_the_right_article():
    with pytest.raises(ArgoError, match="not text; an evaluation is plain text"):
        decode_evaluation(b"\0", "file")
