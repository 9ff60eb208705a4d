"""Tests several engine processes that share a world over the loopback interface. They exchange only removals and must end with
the same world."""

from __future__ import annotations

import json

from conftest import REPO
from helpers.engine_output import complaints
from helpers.engine_process import processes


def test_peers_exchange_removals_and_agree(imported_demo):
    """A server and two clients fell trees concurrently, including some common ones. A third client joins late. They share only
    a seed and removals, and end with at least 10^5 bit-identical instances."""
    script = REPO / "tests/engine/multiplayer.gd"
    with processes() as start:
        server = start("--path", imported_demo, "--script", script, "--", "server")
        port = server.wait_for(r"^port (\d+)$").group(1)
        clients = [start("--path", imported_demo, "--script", script, "--", "client", port, str(n)) for n in (1, 2)]
        results = [json.loads(process.wait_for(r"^result (.*)$").group(1)) for process in (server, *clients)]
        late = start("--path", imported_demo, "--script", script, "--", "late", port)
        results.append(json.loads(late.wait_for(r"^result (.*)$").group(1)))
        for process in (*clients, late, server):
            process.end()

    removed = results[0]["removed"]
    assert removed == results[0]["to_fall"] > 200
    for key in ("before", "after", "state", "removed"):
        assert len({str(result[key]) for result in results}) == 1, (key, results)
    before, after = (int(results[0][key].split()[0]) for key in ("before", "after"))
    assert before == after + removed and after >= 100_000
    # A client only receives removals. Instances themselves would take 48 bytes each.
    for result in results[1:]:
        assert result["received"] < 100 * removed + 5_000, results
    assert results[-1]["received"] < 16 * removed + 5_000, results


def test_the_demo_has_a_server(imported_demo, tmp_path):
    """Runs server.tscn and client.tscn as their comments document. After a client has felled trees, the trees are missing for
    the next client and for a restarted server."""
    scene = "res://gameplay/{}.tscn"
    state = tmp_path / "state.bin"
    with processes() as start:
        arguments = ["--path", imported_demo, scene.format("server"), "--", "--port=0", f"--state={state}"]
        server = start(*arguments)
        port = server.wait_for(r"^server: listening on port (\d+), 0 felled$").group(1)
        counts, felled = [], []
        for _ in range(2):
            client = start("--path", imported_demo, scene.format("client"), "--", f"--port={port}", "--fell=3")
            counts.append(int(client.wait_for(r"^client: (\d+) trees within").group(1)))
            felled += json.loads(client.wait_for(r"^client: felled (\[.*\])$").group(1))
            client.end()
            server.wait_for(rf"^server: \d+ has left, {len(felled)} felled$")
        assert counts[1] == counts[0] - 3 and len(set(felled)) == 6
        server.kill()
        assert not complaints(server.printed), complaints(server.printed)
        start(*arguments).wait_for(r"^server: listening on port \d+, 6 felled$")
