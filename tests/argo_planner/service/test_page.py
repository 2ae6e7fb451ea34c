"""The page is served with what keeps it safe, and says where it has not been built."""

from argo_planner.service.web import page


def test_where_it_is_not_built_the_page_says_how(service, monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(page, "page_folder", lambda: tmp_path)
    answer = service.client.get("/")
    assert answer.status_code == 200
    assert "make page" in answer.text


def test_the_page_and_its_files_are_served(service, monkeypatch, tmp_path) -> None:
    (tmp_path / "assets").mkdir()
    (tmp_path / "index.html").write_text("<title>Argo</title>", encoding="utf-8")
    (tmp_path / "assets" / "index-1234.js").write_text("let a = 1", encoding="utf-8")
    monkeypatch.setattr(page, "page_folder", lambda: tmp_path)
    index = service.client.get("/")
    assert index.text == "<title>Argo</title>"
    assert index.headers["cache-control"] == "no-cache"
    script = service.client.get("/assets/index-1234.js")
    assert script.headers["content-type"].startswith("text/javascript")
    assert "immutable" in script.headers["cache-control"]


def test_what_the_page_does_not_have_is_not_found(service) -> None:
    for name in ("nothing.js", "..%2f..%2fpyproject.toml", "%2e%2e%2findex.html"):
        answer = service.client.get(f"/assets/{name}")
        assert answer.status_code == 404
        assert answer.json()["code"] == "not-found"


def test_who_has_no_token_does_not_get_the_page(service) -> None:
    stranger = service.as_("eve", secret="not-the-token-at-all")
    assert stranger.get("/").status_code == 401
