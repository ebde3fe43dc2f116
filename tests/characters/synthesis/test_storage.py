import json
from pathlib import Path

import numpy as np
import pytest

from cubeling.characters import CharacterError
from cubeling.characters.synthesis.graphs.building import part_graphs, standard_graph
from cubeling.characters.synthesis.graphs.storage import StoredGraph, load_graph, save_graph


@pytest.fixture
def saved(stored: StoredGraph, tmp_path: Path) -> Path:
    path = tmp_path / "my.graph"
    save_graph(stored, path)
    return path


def _changed(saved: Path, **changes: object) -> Path:
    """Write the file again with other arrays, or with another text in its content."""
    with np.load(saved) as archive:
        arrays = {name: archive[name] for name in archive.files}
    content = json.loads(str(arrays["content"]))
    content |= {name: value for name, value in changes.items() if name in content}
    arrays |= {name: value for name, value in changes.items() if name not in content}
    with saved.open("wb") as file:
        np.savez(file, **arrays | {"content": np.array(json.dumps(content))})
    return saved


def test_a_graph_is_read_as_it_was_written(stored: StoredGraph, saved: Path) -> None:
    again = load_graph(saved)
    assert again.library.names == stored.library.names
    assert again.thresholds == stored.thresholds
    assert np.allclose(again.library.poses.rotations, stored.library.poses.rotations, atol=1e-6)
    assert np.allclose(again.library.poses.translations, stored.library.poses.translations)
    assert np.array_equal(again.library.contacts, stored.library.contacts)
    one, two = standard_graph(stored), standard_graph(again)
    assert np.array_equal(one.edges.sources, two.edges.sources)
    assert np.array_equal(one.edges.targets, two.edges.targets)
    assert np.allclose(one.edges.weights, two.edges.weights, atol=1e-5)
    assert np.array_equal(part_graphs(stored).kept, part_graphs(again).kept)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"version": 0}, "written as version 0.*make it again"),
        ({"format": "another"}, "not a motion graph"),
        ({"skeleton": "0123"}, "its skeleton is damaged"),
        ({"joints": ["hips"]}, "my.graph"),
        ({"steps": np.zeros((3, 3))}, "do not belong together"),
        ({"starts": np.array([0, 5])}, "do not belong together"),
        ({"pairs_0": np.full((2, 1), 10**6)}, "its edges are damaged"),
    ],
)
def test_a_file_that_cannot_be_played_is_refused(
    saved: Path, changes: dict[str, object], message: str
) -> None:
    with pytest.raises(CharacterError, match=message):
        load_graph(_changed(saved, **changes))


@pytest.mark.parametrize("content", ["[]", "[1, 2]", '"x"', "nonsense", '{"format": 3}'])
def test_another_text_in_its_place_is_refused_in_one_line(saved: Path, content: str) -> None:
    with saved.open("wb") as file:
        np.savez(file, content=np.array(content))
    with pytest.raises(CharacterError, match="not a motion graph") as caught:
        load_graph(saved)
    assert str(caught.value).isprintable()


def test_an_archive_of_far_more_than_its_size_is_not_unpacked(saved: Path) -> None:
    with saved.open("wb") as file:
        np.savez_compressed(file, zeros=np.zeros(4_000_000))
    assert saved.stat().st_size < 50_000
    with pytest.raises(CharacterError, match="bytes stand for 32000"):
        load_graph(saved)


@pytest.mark.parametrize("keep", [0, 3, 2000, -20])
def test_a_damaged_file_is_refused_in_one_line(saved: Path, keep: int) -> None:
    saved.write_bytes(saved.read_bytes()[:keep])
    with pytest.raises(CharacterError, match=r"not a motion graph") as caught:
        load_graph(saved)
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CharacterError, match="No such file"):
        load_graph(tmp_path / "no.graph")
