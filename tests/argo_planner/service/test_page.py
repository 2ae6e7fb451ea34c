"""The page and its files are served, or a hint on how to build it."""

from argo_planner.service.web import page


def test_without_a_built_page_the_service_shows_how_to_build_it(
    service, monkeypatch, tmp_path
) -> None:
    monkeypatch.setattr(page, "page_folder_path", lambda: tmp_path)
    answer = service.client.get("/")
    assert answer.status_code == 200
    assert "make page" in answer.text


def test_the_page_and_its_files_are_served(service, monkeypatch, tmp_path) -> None:
    (tmp_path / "assets").mkdir()
    (tmp_path / "index.html").write_text("<title>Argo</title>", encoding="utf-8")
    (tmp_path / "assets" / "index-1234.js").write_text("let a = 1", encoding="utf-8")
    monkeypatch.setattr(page, "page_folder_path", lambda: tmp_path)
    index = service.client.get("/")
    assert index.text == "<title>Argo</title>"
    assert index.headers["cache-control"] == "no-cache"
    script = service.client.get("/assets/index-1234.js")
    assert script.headers["content-type"].startswith("text/javascript")
    assert "immutable" in script.headers["cache-control"]


def test_files_are_compressed_for_clients_that_accept_it(service, monkeypatch, tmp_path) -> None:
    (tmp_path / "assets").mkdir()
    (tmp_path / "index.html").write_text("<!doctype html>", encoding="utf-8")
    text = "let a = 1;\n" * 1_000
    (tmp_path / "assets" / "index-1234.js").write_text(text, encoding="utf-8")
    monkeypatch.setattr(page, "page_folder_path", lambda: tmp_path)
    for accepted, encoding in (
        ("gzip, deflate, br", "gzip"),
        ("br;q=1.0, gzip;q=0.5", "gzip"),
        ("*", "gzip"),
        ("gzip;q=0", None),
        ("br", None),
        ("", None),
    ):
        answer = service.client.get("/assets/index-1234.js", headers={"accept-encoding": accepted})
        assert answer.text == text
        assert answer.headers.get("content-encoding") == encoding, accepted
        assert answer.headers["vary"] == "accept-encoding"
        assert "max-age=31536000" in answer.headers["cache-control"]
        if encoding:
            assert int(answer.headers["content-length"]) < len(text) / 10
    small = service.client.get("/", headers={"accept-encoding": "gzip"})
    assert small.text == "<!doctype html>"
    assert "content-encoding" not in small.headers


def test_a_file_that_the_page_does_not_have_is_not_found(service) -> None:
    for name in ("nothing.js", "..%2f..%2fpyproject.toml", "%2e%2e%2findex.html"):
        answer = service.client.get(f"/assets/{name}")
        assert answer.status_code == 404
        assert answer.json()["code"] == "not-found"


def test_a_client_without_a_token_does_not_get_the_page(service) -> None:
    client = service.as_("eve", secret="not-the-token-at-all")
    assert client.get("/").status_code == 401
