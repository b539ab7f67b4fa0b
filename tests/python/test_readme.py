"""The sessions of tools/python/README.md."""

import doctest
import os

from conftest import ROOT


def test_sessions():
    before = os.getcwd()
    os.chdir(ROOT)
    try:
        found = doctest.testfile(str(ROOT / "tools" / "python" / "README.md"), module_relative=False,
                                 optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    finally:
        os.chdir(before)
    assert found.attempted > 30 and found.failed == 0


def test_the_documents_of_the_repository():
    """Blocks of Python that import mbd, wherever they stand."""
    found = 0
    before = os.getcwd()
    os.chdir(ROOT)
    try:
        for file in (ROOT / "README.md", *sorted(ROOT.glob("models/*.md")), *sorted(ROOT.glob("libmbd/*.md"))):
            for block in file.read_text(encoding="utf-8").split("```python\n")[1:]:
                code = block.split("```")[0]
                if "import mbd" in code:
                    exec(compile(code, str(file), "exec"), {})  # noqa: S102
                    found += 1
    finally:
        os.chdir(before)
    assert found > 0
