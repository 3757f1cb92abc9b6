"""The page's files over HTTP: compressed, revalidated, and no others."""

from __future__ import annotations

import gzip

from search.server.static_page import FOLDER


def test_text_is_compressed_for_those_who_read_gzip(client):
    plain = client.get("/main.js", headers={"Accept-Encoding": "identity"})
    assert "Content-Encoding" not in plain.headers
    with client.stream("GET", "/main.js", headers={"Accept-Encoding": "gzip"}) as response:
        raw = b"".join(response.iter_raw())
    assert (response.headers["Content-Encoding"], response.headers["Vary"]) == ("gzip", "Accept-Encoding")
    assert response.headers["Content-Type"].startswith("text/javascript")
    assert gzip.decompress(raw) == plain.content == (FOLDER / "main.js").read_bytes()
    font = client.get("/vendor/inter/inter-latin-wght-normal.woff2")
    assert "Content-Encoding" not in font.headers


def test_what_a_browser_has_is_not_sent_again(client):
    for encoding in ("gzip", "identity"):
        tag = client.get("/main.js", headers={"Accept-Encoding": encoding}).headers["ETag"]
        again = client.get("/main.js", headers={"Accept-Encoding": encoding, "If-None-Match": tag})
        assert (again.status_code, again.content) == (304, b"")


#: What is loaded when it is needed.
LATER = {"sign_in.html", "sign_in.js", "composer.js", "line.js", "compose.css"}


def test_the_page_is_less_than_300_kb_on_the_wire(client):
    total = 0
    for file in FOLDER.rglob("*"):
        if file.is_file() and file.suffix != ".txt" and file.name not in LATER:
            with client.stream(
                "GET", f"/{file.relative_to(FOLDER).as_posix()}", headers={"Accept-Encoding": "gzip"}
            ) as response:
                total += len(b"".join(response.iter_raw()))
    assert 200_000 < total < 300_000
