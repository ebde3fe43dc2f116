"""The site: links that hold, headings that can be linked to, and every public name."""

import pytest

from tools.site.guides import Guides
from tools.site.links import broken_links
from tools.site.reference import faces

INDEX = "# All\n\n## First\n\n- [Home](../README.md): begin\n- [A page](page.md): more\n"


@pytest.fixture
def make(tmp_path):
    """Make the site of pages given by path, and return its folder."""

    def make(**pages):
        root = tmp_path / "repository"
        for name, text in {"README.md": "# Home", "docs/README.md": INDEX, **pages}.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, "utf-8")
        Guides(root, tmp_path / "site").make()
        (tmp_path / "site/api").mkdir()
        (tmp_path / "site/api/index.html").write_text("the reference")
        return tmp_path / "site"

    return make


def test_links_lead_to_pages_sources_and_folders(make):
    links = "[home](../README.md) [code](../tools/a.py) [all](../tools) [there](#one-two)"
    page = f"# A page\n\n{links}\n\n## One: two!"
    site = make(**{"docs/page.md": page, "tools/a.py": "x = 1\n"})
    assert broken_links(site) == []
    shown = (site / "docs/page.html").read_text("utf-8")
    for link in ("../index.html", "../tools/a.py.html", "../tools/index.html", "#one-two"):
        assert f'href="{link}"' in shown
    assert 'href="a.py.html"' in (site / "tools/index.html").read_text("utf-8")


@pytest.mark.parametrize(
    ("link", "problem"),
    [
        ("missing.md", "missing.md: there is no such file"),
        ("page.md#nowhere", "page.html#nowhere: there is no such place in that page"),
        ("#nowhere", "#nowhere: there is no such place in that page"),
        ("../../outside.md", "../../outside.md: there is no such file"),
    ],
)
def test_a_link_that_leads_nowhere_is_found(make, link, problem):
    site = make(**{"docs/page.md": f"# A page\n\n[there]({link})"})
    assert broken_links(site) == [f"docs/page.html: {problem}"]


def test_headings_are_named_as_on_github(make):
    page = "# A page\n\n## `cubeling` – how?\n\n## Twice\n\n## Twice\n"
    site = make(**{"docs/page.md": page})
    shown = (site / "docs/page.html").read_text("utf-8")
    for name in ("cubeling--how", "twice", "twice-1"):
        assert f'<h2 id="{name}">' in shown


def test_every_page_lists_all_pages_and_marks_itself(make):
    site = make(**{"docs/page.md": "# A page"})
    assert '<a href="page.html" aria-current="page">A page</a>' in (
        site / "docs/page.html"
    ).read_text("utf-8")
    assert '<a href="docs/page.html">A page</a>' in (site / "index.html").read_text("utf-8")


def test_the_faces_of_all_rooms_are_known():
    assert {"cubeling.affect", "cubeling.characters.motion", "cubeling.robot.network"} <= {*faces()}
