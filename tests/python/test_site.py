"""The site that tools/site makes: without warnings, whole, and what it says can be found.

Tried in it, and killed: a link to a page, to a heading and to a file that are not there; a page left out; a notebook that fails; a
header of the interface without its text.
"""

import html.parser
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import urllib.parse

import pytest

from conftest import ROOT

missing = [name for name in ("sphinx", "myst_parser", "furo", "nbclient", "ipykernel", "matplotlib") if importlib.util.find_spec(name) is None]
pytestmark = pytest.mark.skipif(bool(missing), reason=f"Python has no {', '.join(missing)} (tools/install-dependencies --with-site)")


class Page(html.parser.HTMLParser):
    def __init__(self, file):
        super().__init__()
        self.ids, self.links, self.text = set(), [], ""
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.ids.update(given[key] for key in ("id", "name") if given.get(key))
        self.links += [given[key] for key in ("href", "src") if given.get(key)]

    def handle_data(self, data):
        self.text += data


def make(out, *more, root=ROOT):
    return subprocess.run([sys.executable, root / "tools" / "site", "--out", out, *more], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    out = tmp_path_factory.mktemp("site")
    done = make(out)
    assert done.returncode == 0 and "WARNING" not in done.stdout, done.stdout[-5000:]
    return out / "html"


def test_every_link_leads_somewhere(site):
    pages = {file.resolve(): Page(file) for file in site.rglob("*.html")}
    assert len(pages) > 60
    seen = 0
    for file, page in pages.items():
        for link in page.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                assert parts.scheme in ("http", "https", "data", "mailto"), link
                continue
            target = (file.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else file
            assert target.exists(), f"{file}: {link}"
            if parts.fragment and target in pages and parts.fragment != "":
                assert urllib.parse.unquote(parts.fragment) in pages[target].ids, f"{file}: {link}"
            seen += 1
    assert seen > 2000


def test_what_it_has(site):
    def text(name):
        return " ".join(Page(site / name).text.split())
    assert "Computes how machines made of rigid and bending parts move" in text("index.html")
    assert "mbd sweep MODEL --vary" in text("models/GUIDE.html")
    assert "generalized_alpha" in text("models/MANUAL.html")
    assert "Runs a model for many values of parameters" in text("api/python.html")
    assert "RunReport run(" in text("api/libmbd/run/run.hpp.html")
    for name in ("four_bar", "shaft", "controlled_arm", "sweep"):
        page = Page(site / "notebooks" / f"{name}.html")
        assert sum("_images" in link and link.endswith(".png") for link in page.links) >= 1, name
    assert "46 of 46 done" in text("notebooks/sweep.html")


def test_search_finds_it(site):
    index = (site / "searchindex.js").read_text(encoding="utf-8")
    index = json.loads(index[index.index("(") + 1:index.rindex(")")])
    names = index["docnames"]

    def found(word):
        places = {**index["terms"], **index["titleterms"]}.get(word, [])
        return {names[k] for k in (places if isinstance(places, list) else [places])}
    assert "models/MANUAL" in found("cylindr")  # a stem
    assert "tools/python/README" in found("latin") and "notebooks/shaft" in found("critic")
    assert "api/libmbd/run/run.hpp" in found("runreport")


def test_what_is_wrong_is_said(tmp_path):
    """A copy of what it is made of, with a fault."""
    root = tmp_path / "root"
    files = subprocess.run(["git", "ls-files", "*.md", "*.hpp", "*.svg", "*.png", "*.webp", "models/*", "LICENSE", "tools/site",
                            "tools/studies/results/*", "tools/python/notebooks/*", "tests/hard/*", "tests/bad_models/*"], cwd=ROOT,
                           text=True, capture_output=True, check=False).stdout.split()
    if not files:
        pytest.skip("no checkout of git")
    for file in files:
        (root / file).parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / file).exists():
            shutil.copyfile(ROOT / file, root / file)
    guide = root / "models" / "GUIDE.md"
    whole = guide.read_text(encoding="utf-8")
    for fault in ("[a page](NOWHERE.md)", "[a heading](MANUAL.md#that-is-not-there)", "![a picture](nowhere.svg)"):
        guide.write_text(f"{whole}\n\n{fault}\n", encoding="utf-8")
        done = make(tmp_path / "out", "--no-notebooks", root=root)
        assert done.returncode != 0 and "GUIDE.md" in done.stdout and "WARNING" in done.stdout, (fault, done.stdout)
    environment = dict(os.environ, PYTHONPATH="")
    done = subprocess.run([sys.executable, "-I", root / "tools" / "site"], env=environment, text=True, capture_output=True, check=False)
    assert done.returncode != 0 and "Python has no mbd" in done.stderr
