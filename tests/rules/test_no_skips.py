"""What runs on every change promises to run everything: there a skipped test is a failed one."""

import os
import pathlib
import subprocess
import sys

import pytest

CONFTEST = pathlib.Path(__file__).parents[1] / "conftest.py"


@pytest.mark.parametrize(
    "code",
    [
        "import pytest\n@pytest.mark.skip(reason='no browser')\ndef test_it(): pass",
        "import pytest\ndef test_it(): pytest.skip('no browser')",
        "import pytest\npytest.skip('no browser', allow_module_level=True)",
    ],
)
@pytest.mark.parametrize("everything", [True, False])
def test_a_skip_fails_where_all_is_to_run(tmp_path, code, everything):
    (tmp_path / "conftest.py").write_text(CONFTEST.read_text(encoding="utf-8"))
    (tmp_path / "test_it.py").write_text(code)
    environment = {**os.environ, "AUREOLE_NO_SKIPS": "1" if everything else ""}
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-p", "no:xdist", str(tmp_path)]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert ("failed" in done.stdout or "error" in done.stdout) == everything, done.stdout
    assert ("skipped" in done.stdout.splitlines()[-1]) != everything
    assert "no browser" in done.stdout or not everything
