import re
from pathlib import Path

import pytest
import yaml

from argo_compiler.base.errors import ArgoError
from argo_env.files import resources
from argo_env.site import load_site


class _Plain(yaml.SafeDumper):
    """Dumper without anchors, so that a change of one part does not change another."""

    def ignore_aliases(self, data):  # noqa: ARG002
        return True


UMAD = (resources.scenarios_folder() / "umad" / "site.yaml").read_text(encoding="utf-8")


@pytest.fixture
def description():
    return yaml.safe_load(UMAD)


def refusal(path):
    with pytest.raises(ArgoError) as caught:
        load_site(str(path))
    return str(caught.value)


def written(tmp_path, content):
    path = tmp_path / "site.yaml"
    if isinstance(content, dict):
        content = yaml.dump(content, Dumper=_Plain, sort_keys=False)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_a_file_gives_the_same_site(tmp_path, description, umad):
    assert load_site(str(written(tmp_path, description))) == umad


@pytest.mark.parametrize("name", ["nowhere", "", "..", "umad/site", "UMAD\n", "a\0b"])
def test_unknown_name(name):
    message = refusal(name)
    assert name in message
    assert "umad" in message


@pytest.mark.parametrize(
    "name", ["missing.yaml", "missing/site.yml", "a\0b.yaml", "a" * 5000 + ".yaml"]
)
def test_missing_file(tmp_path, name):
    assert name in refusal(tmp_path / name)


@pytest.mark.parametrize("name", ["", " ", "a/b", "../x", "a\\b", ".", "a\tb", "a" * 300])
def test_a_name_that_no_file_can_have(tmp_path, description, name):
    message = refusal(written(tmp_path, description | {"name": name}))
    assert "site.yaml" in message
    assert "name" in message


def test_a_folder_is_no_site(tmp_path):
    folder = tmp_path / "folder.yaml"
    folder.mkdir()
    assert str(folder) in refusal(folder)


@pytest.mark.parametrize(
    "content",
    [
        "",
        "name: [",
        "a: b: c",
        "- 1\n- 2",
        "just text",
        "!!python/object:os.system {}",
        "{[1]: 2}",
        "when: 2020-13-45",
        "number: " + "1" * 5000,
        "[" * 600,
        b"\xff\xfe\x00",
        b"name: \x00",
        b"\x89PNG\r\n",
    ],
)
def test_a_text_that_describes_no_site(tmp_path, content):
    path = written(tmp_path, content)
    assert str(path) in refusal(path)


def change(description, where, value):
    *parents, last = where
    part = description
    for key in parents:
        part = part[key]
    part[last] = value


@pytest.mark.parametrize(
    ("where", "value", "place"),
    [
        (("roof",), 1, "roof"),
        (("floors", 2, "colour"), "red", "floors[2].colour"),
        (("floors", 1, "number"), 7, "numbered"),
        (("floors", 1, "checkpoints", 0, "id"), 1, "checkpoint 1 occurs twice"),
        (("floors", 1, "checkpoints", 0, "tags"), ["PI-1", "pi-1"], "tag PI-1 occurs twice"),
        (("floors", 1, "checkpoints", 0, "tags"), "PI-1", "floors[1].checkpoints[0].tags"),
        (("floors", 1, "checkpoints", 0, "kind"), "lever", "floors[1].checkpoints[0].kind"),
        (
            ("floors", 1, "checkpoints", 0, "nominal", "low"),
            99.0,
            "floors[1].checkpoints[0].nominal",
        ),
        (
            ("floors", 1, "checkpoints", 0, "position"),
            [1.0, 2.0],
            "floors[1].checkpoints[0].position",
        ),
        (("floors", 1, "z"), float("nan"), "floors[1].z"),
        (("floors", 1, "walkways"), {}, "floors[1].walkways"),
        (("floors", 1, "walkways", "south aisle"), [5.0, 1.0, 2.0, 2.0], "walkways.south aisle"),
        (("floors",), [], "floors"),
        (("areas",), [], "areas"),
        (("towers", 0, "flights", 0, "risers"), 1, "towers[0].flights[0].risers"),
        (("pipes", 0, "points"), [[0.0, 0.0, 0.0]], "pipes[0].points"),
        (("pipes", 0, "points"), [[1.0, 1.0, 1.0], [1.0, 1.0, 1.0]], "pipes[0]"),
        (("vessels", 0, "radius"), -1.0, "vessels[0].radius"),
        (("ground",), [5.0, 0.0, 1.0, 1.0], "ground"),
    ],
)
def test_mistakes_are_named_by_their_place(tmp_path, description, where, value, place):
    change(description, where, value)
    path = written(tmp_path, description)
    message = refusal(path)
    assert str(path) in message
    assert place in message


def test_site_of_one_slab(tmp_path):
    path = written(
        tmp_path,
        """
        {name: yard, title: Yard, storey: 3, ground: [0, 0, 8, 8], ground_z: 0, towers: [],
         floors: [{number: 1, z: 0.02, railed: false, walkways: {slab: [1, 1, 7, 7]}}],
         areas: [{number: 1, dock: [3, 3, 90]}]}
        """,
    )
    site = load_site(str(path))
    assert site.checkpoints == ()
    assert [e.name for e in site.elements] == ["gravel", "floor 1 slab", "docking station 1"]


def test_a_ground_too_large_for_navigation_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "huge.yaml"
    path.write_text(UMAD.replace("ground: [-2.0", "ground: [-900.0"), encoding="utf-8")
    with pytest.raises(ArgoError, match="larger than 200 m"):
        load_site(str(path))


@pytest.mark.parametrize(
    ("where", "value", "says"),
    [
        (("towers", 0, "flights", 0, "risers"), 100_000, "`risers` has to be at most 100"),
        (("towers", 0, "flights", 0, "rise"), 1e9, "`rise` has to be at most 2"),
        (("towers", 0, "flights", 0, "foot", 1), 1e9, "`foot[1]` has to be at most 10000"),
        (("floors", 0, "walkways", "slab", 2), 900.0, "it is larger than 200 m by 200 m"),
        (
            ("floors", 0, "barriers"),
            {"fence": [[0, 0], [0, 9000]]},
            "barriers.fence: it is longer than 200 m",
        ),
        (("floors", 0, "vessels"), [{"radius": 1e6}], "`radius` has to be at most 50"),
        (("columns",), [[0, 0]] * 5000, "`columns` has to be a list of at most 1000"),
        (("pipes", 0, "points", 0, 2), -1e7, "`points[0][2]` has to be at least -10000"),
        (("storey",), 1e6, "`storey` has to be at most 200"),
    ],
)
def test_sizes_that_no_site_has_are_refused_with_their_place(tmp_path, where, value, says):
    """Before solids are made of them by the million."""
    text = (resources.scenarios_folder() / "darmstadt" / "site.yaml").read_text("utf-8")
    whole = yaml.safe_load(text)
    change(whole, where, value)
    message = refusal(written(tmp_path, whole))
    assert says in message
    assert re.search(r"site.yaml:\d+:\d+: error", message)


@pytest.mark.parametrize(
    ("where", "thing"),
    [
        (("areas",), "starting area 1"),
        (("places",), "place"),
        (("vessels",), "equipment"),
        (("pipes",), "equipment"),
        (("towers",), "tower"),
        (("towers", 0, "flights"), "in west tower"),
        (("floors", 0, "pumps"), "equipment"),
    ],
)
def test_names_and_numbers_are_unique(tmp_path, description, where, thing):
    part = description
    for step in where:
        part = part[step]
    part.append(part[0])
    path = written(tmp_path, description)
    message = refusal(path)
    assert "occurs twice" in message
    assert thing in message
    index = len(part) - 1
    assert f"{where[-1]}[{index}]." in message


def test_mistakes_are_shown_in_their_line(tmp_path):
    text = UMAD.replace("storey: 2.5", "storey: -2.5\nstory: 2.5")
    path = written(tmp_path, text)
    number = text.split("\n").index("storey: -2.5") + 1
    message = refusal(path)
    assert f"{path}:{number}:9: error: storey: " in message
    assert f"{path}:{number + 1}:1: error: story: " in message
    assert "is `storey` meant?" in message


def test_keys_are_unique(tmp_path, umad):
    path = written(tmp_path, UMAD + "\nname: other\n")
    message = refusal(path)
    line = UMAD.split("\n").index("name: umad") + 1
    assert f"`name` is given twice; it was first given at line {line}" in message
    assert load_site(str(written(tmp_path, UMAD))) == umad
