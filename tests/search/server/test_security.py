"""Security: hosts, origins, the token, paths, and the headers of every response."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from search.server.security import is_loopback

TOKEN = "a-token-that-nobody-guesses"
SCRIPT = '</script><script>alert("1")</script>'


@pytest.mark.parametrize("host", ["127.0.0.1", "127.0.0.1:8420", "localhost:9999", "LOCALHOST", "[::1]:8420"])
def test_loopback_hosts_are_accepted(client, host):
    assert client.get("/healthz", headers={"Host": host}).status_code == 200


@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        "127.0.0.1.evil.example",
        "localhost.evil.example:8420",
        "192.168.0.7",
        "",
        "[",
        "a@localhost:1:2",
    ],
)
def test_other_hosts_are_rejected(client, host):
    response = client.get("/api/search?q=walks", headers={"Host": host})
    assert (response.status_code, list(response.json())) == (421, ["error"])


def test_bound_to_all_addresses_any_address_is_accepted_but_no_other_name(served):
    client = served(host="0.0.0.0", names=["studio.example"], token=None)
    codes = {
        host: client.get("/healthz", headers={"Host": host}).status_code
        for host in ("192.168.0.7:8420", "[fe80::1]", "studio.example", "evil.example", "0x7f.1")
    }
    assert codes == {
        "192.168.0.7:8420": 200,
        "[fe80::1]": 200,
        "studio.example": 200,
        "evil.example": 421,
        "0x7f.1": 421,
    }


@pytest.mark.parametrize(
    ("headers", "code"),
    [
        ({"Origin": "http://127.0.0.1:8420"}, 200),
        ({"Origin": "http://127.0.0.1:9999"}, 403),
        ({"Origin": "https://evil.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Origin": "http://["}, 403),
        ({"Origin": "http://127.0.0.1:8420@evil.example"}, 403),
        ({"Sec-Fetch-Site": "same-origin"}, 200),
        ({"Sec-Fetch-Site": "none"}, 200),
        ({"Sec-Fetch-Site": "cross-site"}, 403),
        ({"Sec-Fetch-Site": "same-site"}, 403),
        ({"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate"}, 403),
    ],
)
def test_cross_origin_requests_are_rejected(client, headers, code):
    assert client.get("/api/skeleton", headers=headers).status_code == code
    posted = client.post("/api/describe?name=x.bvh", headers=headers, content=b"x")
    assert posted.status_code == (403 if code == 403 else 422)


def test_a_link_on_another_site_opens_the_page(client):
    headers = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate"}
    assert client.get("/", headers=headers).status_code != 403


def test_requests_without_the_token_are_rejected(served):
    client = served(token=TOKEN)
    for url in ("/", "/api/search?q=walks", "/api/motions/1/joints", "/metrics", "/openapi.json", "/nothing"):
        response = client.get(url)
        assert (response.status_code, list(response.json())) == (401, ["error"]), url
    assert client.get("/healthz").status_code == 200


@pytest.mark.parametrize(
    "headers",
    [
        {"Authorization": "Bearer wrong"},
        {"Authorization": f"Basic {TOKEN}"},
        {"Authorization": f"Bearer {TOKEN}x"},
        {"Authorization": ""},
        {"Cookie": "motionseek_token_8420=wrong"},
        {"Cookie": "motionseek_token_8420"},
        {"Cookie": f"motionseek_token_8420={TOKEN}"},
    ],
)
def test_a_wrong_token_is_rejected(served, headers):
    assert served(token=TOKEN).get("/api/skeleton", headers=headers).status_code == 401


def test_the_right_token_as_bearer(served):
    assert served(token=TOKEN).get("/api/skeleton", headers={"Authorization": f"bearer {TOKEN}"}).status_code == 200


def test_a_link_with_the_token_becomes_a_cookie(served):
    client = served(token=TOKEN)
    response = client.get(f"/?q=walks&token={TOKEN}", follow_redirects=False)
    assert (response.status_code, response.headers["location"]) == (303, "/?q=walks")
    cookie = response.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=lax" in cookie
    assert client.get("/api/skeleton").status_code == 200, "the cookie is enough from then on"
    client.cookies.clear()
    assert client.get("/api/skeleton?token=" + TOKEN).status_code == 401, "only the page takes it from a link"


def test_a_browser_without_the_token_is_asked_for_it_and_programs_get_an_error(served):
    client = served(token=TOKEN)
    asked = client.get(
        "/", headers={"Accept": "text/html,*/*", "Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate"}
    )
    assert asked.status_code == 401
    assert "<form" in asked.text
    for part in ("/sign_in.js", "/style.css"):
        assert client.get(part).status_code == 200
    wrong = client.post("/sign-in", headers={"Authorization": "Bearer wrong"})
    assert (wrong.status_code, list(wrong.json())) == (401, ["error"])
    assert client.get("/api/skeleton").status_code == 401
    assert client.post("/sign-in", headers={"Authorization": f"Bearer {TOKEN}"}).status_code == 204
    assert client.get("/api/skeleton").status_code == 200, "the cookie is enough from then on"
    elsewhere = {"Authorization": f"Bearer {TOKEN}", "Origin": "https://evil.example"}
    assert client.post("/sign-in", headers=elsewhere).status_code == 403


@pytest.mark.parametrize("others", ["a[b]=c", 'json={"a":1}', "a=b c", "\xfc=1", "=", "motionseek_token_9000=x"])
def test_cookies_of_others_do_not_hide_ours(served, others):
    client = served(token=TOKEN)
    ours = client.get("/", params={"token": TOKEN}, follow_redirects=False).headers["set-cookie"].partition(";")[0]
    client.cookies.clear()
    for cookies in (f"{others}; {ours}", f"{ours}; {others}"):
        headers = {"Cookie": cookies.encode("latin-1")}
        assert client.get("/api/skeleton", headers=headers).status_code == 200


def test_the_cookie_is_not_the_token_and_belongs_to_one_port(served):
    response = served(token=TOKEN).get("/", params={"token": TOKEN}, follow_redirects=False)
    assert TOKEN not in response.headers["set-cookie"]
    assert response.headers["set-cookie"].startswith("motionseek_token_8420=")


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.8.8", "::1", "localhost"])
def test_loopback_addresses(host):
    assert is_loopback(host)


@pytest.mark.parametrize("host", ["0.0.0.0", "", "::", "10.0.0.1", "studio"])
def test_other_addresses(host):
    assert not is_loopback(host)


@pytest.mark.parametrize(
    "url",
    [
        "/../../../etc/passwd",
        "/..%2f..%2f..%2fetc%2fpasswd",
        "/%2e%2e/%2e%2e/pyproject.toml",
        "/....//....//etc/passwd",
        "/..%5c..%5cpyproject.toml",
        "/%00.html",
        "//etc/passwd",
        "/__init__.py",
        "/app.js%00.py",
        "/api/motions/..%2f..%2f1",
        "/api/motions/%2fetc%2fpasswd",
        "/api/export?clip=../../etc/passwd",
        "/api/export?clip=%2Fetc%2Fpasswd",
        "/api/export?clip=1&format=../../x",
        "/api/describe?clip=%2Fetc%2Fpasswd",
        "/api/similar?clip=%23x",
    ],
)
def test_paths_do_not_reach_the_file_system(client, url):
    response = client.get(url)
    assert response.status_code in (404, 422), response.text
    assert "root:" not in response.text
    assert "[project]" not in response.text


@pytest.mark.parametrize(
    "value", ["' OR 1=1 --", "*' OR '1'='1", "x'); DROP TABLE clips; --", '"', "%", "[", "\\", "\0"]
)
@pytest.mark.parametrize("name", ["path", "rig", "format"])
def test_filters_are_bound_values(client, ask, name, value):
    response = client.get("/api/motions", params={name: value})
    assert response.status_code == 200
    assert response.json()["total"] == 0
    assert ask("/api/motions")["total"] == 5


def test_sentences_are_text(client):
    for sentence in ("'; DROP TABLE texts; --", SCRIPT, "x\0y", "\u202e walks", "🕺 dances", "{{7*7}}", "%s%n"):
        response = client.get("/api/search", params={"q": sentence})
        assert response.status_code == 200
        assert response.json()["query"] == sentence


def test_a_link_that_leads_out_of_the_folder_is_not_followed(served, tmp_path: Path):
    client = served()
    secret = tmp_path / "secret.bvh"
    secret.write_text("HIERARCHY\nROOT secret\n")
    inside = tmp_path / "takes" / "deep er" / "bücken.bvh"
    inside.unlink()
    inside.symlink_to(secret)
    number = next(m["clip"] for m in client.get("/api/motions").json()["motions"] if m["format"] == "bvh")
    response = client.get("/api/export", params={"clip": number})
    assert response.status_code == 200
    assert b"secret" not in response.content
    assert b"ROOT pelvis" in response.content, "the stored poses are exported in its place"


def test_every_response_has_security_headers(client, number):
    answers = [
        client.get("/"),
        client.get("/api/skeleton"),
        client.get("/api/nothing"),
        client.get(f"/api/motions/{number('take 1.npy')}/joints"),
        client.get("/healthz", headers={"Host": "evil.example"}),
    ]
    for response in answers:
        policy = dict(part.strip().split(" ", 1) for part in response.headers["content-security-policy"].split(";"))
        assert policy["default-src"] == "'none'"
        assert policy["script-src"] == "'self'"
        assert "unsafe" not in response.headers["content-security-policy"]
        assert response.headers["x-content-type-options"] == "nosniff"
        assert response.headers["cross-origin-resource-policy"] == "same-origin"
        assert "access-control-allow-origin" not in response.headers


def test_script_in_names_and_captions_stays_text(served, bundle, tmp_path: Path):
    import shutil

    from indexer.ingest import indexing

    client = served()
    folder = tmp_path / "takes"
    # A file name cannot hold a slash; a caption can hold anything.
    shutil.copy(folder / "take 1.npy", folder / '<img src=x onerror="alert(1)">.npy')
    (folder / '<img src=x onerror="alert(1)">.txt').write_text(SCRIPT, encoding="utf-8")
    indexing.index(folder, bundle=bundle, jobs=1)
    other = served()
    response = other.get("/api/search", params={"q": "walks", "k": 10})
    hit = next(hit for hit in response.json()["hits"] if hit["path"].startswith("<img"))
    assert hit["caption"] == SCRIPT
    assert response.headers["content-type"] == "application/json"
    exported = other.get("/api/export", params={"clip": hit["clip"]}).headers["content-disposition"]
    assert "\n" not in exported
    assert exported.startswith("attachment;")
    assert json.loads(client.get("/api/skeleton").text)


def test_an_internal_error_reveals_nothing(indexed, bundle, monkeypatch):
    from starlette.testclient import TestClient

    from search.server.app import create_app
    from search.server.snapshot_library import SnapshotLibrary

    app = create_app(SnapshotLibrary.open(indexed, bundle=bundle))
    monkeypatch.setattr(SnapshotLibrary, "stats", lambda self: 1 / 0)
    with TestClient(app, base_url="http://127.0.0.1", raise_server_exceptions=False) as client:
        response = client.get("/api/stats")
    assert response.status_code == 500
    assert list(response.json()) == ["error"]
    assert "division" not in response.text
    assert "content-security-policy" in response.headers
