"""Tests of evaluation files: what a file may name without being trusted."""

import pytest

from argo_compiler.base.errors import Invalid, Remedy
from argo_env.evaluation.file import decode_evaluation

OUTSIDE = (
    "../m.txt",
    "a/../../m.txt",
    "/etc/m.txt",
    "a\\\\..\\\\m.txt",
    "c:/m.txt",
    "\\\\host/m.txt",
    "C:m.txt",
)


def test_a_policy_that_is_code_is_refused_unless_the_file_is_trusted():
    text = b"missions: [m.txt]\npolicies: [as written, 'mine:order']\n"
    with pytest.raises(Invalid, match=r"^file: the policy `mine:order` is code") as caught:
        decode_evaluation(text, "file")
    assert caught.value.remedies == (Remedy.TRUST,)
    assert "\n" not in str(caught.value)
    assert decode_evaluation(text, "file", trusted=True).policies[1] == "mine:order"


@pytest.mark.parametrize("name", OUTSIDE)
@pytest.mark.parametrize(
    "text",
    [
        "missions: ['NAME']",
        "missions: [{file: 'NAME', name: m}]",
        "missions: [m.txt]\nsites: [umad, 'NAME']",
        "missions: [m.txt]\nfaults: [none, 'NAME']",
        "missions: [m.txt]\nfaults: {file: 'NAME'}",
    ],
)
def test_names_stay_in_the_folder_of_the_file_unless_it_is_trusted(text, name):
    content = text.replace("NAME", name).encode()
    with pytest.raises(
        Invalid, match=r"^file: `.*` is outside of the folder of the file"
    ) as caught:
        decode_evaluation(content, "file")
    assert caught.value.remedies == (Remedy.TRUST,)
    decode_evaluation(content, "file", trusted=True)


@pytest.mark.parametrize("link", ["m.txt", "sub", "faults/f.yaml", "sub/deeper"])
def test_links_stay_in_the_folder_of_the_file_unless_it_is_trusted(tmp_path, link):
    folder = tmp_path / "folder"
    for path in (tmp_path / "outside", folder / "sub", folder / "faults"):
        path.mkdir(parents=True)
    for path in (folder / "m.txt", folder / "faults" / "f.yaml", tmp_path / "outside" / "m.txt"):
        path.touch()
    text = b"missions: [m.txt, sub/m.txt, sub/deeper/m.txt]\nfaults: [none, faults]\n"
    assert decode_evaluation(text, "file", folder=folder)
    path = folder / link
    if path.is_file():
        path.unlink()
    elif path.is_dir():
        path.rmdir()
    path.symlink_to(tmp_path / "outside")
    with pytest.raises(Invalid, match=r"is outside of the folder of the file") as caught:
        decode_evaluation(text, "file", folder=folder)
    assert caught.value.remedies == (Remedy.TRUST,)
    assert decode_evaluation(text, "file", trusted=True, folder=folder)
    path.unlink()
    path.symlink_to(folder)
    assert decode_evaluation(text, "file", folder=folder)


def test_names_in_the_folder_and_names_of_sites_are_no_paths_outside():
    text = (
        "missions: [m.txt, a/b/m.txt, ./m.txt, 'a..b.txt']\n"
        "sites: [umad, 'generated:floors=3,seed=7', yard.yaml]\nfaults: [none, faults]\n"
    )
    assert len(decode_evaluation(text.encode(), "file").missions) == 4
