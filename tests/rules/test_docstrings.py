"""Every public name says what it takes, in which unit, and what it refuses (numpydoc)."""

import importlib
import inspect
import pathlib
import pkgutil

import pytest
from numpydoc.validate import validate

import aureole

# The parts of the numpydoc contract that are kept: summary, parameters, returns.
KEPT = {"GL08", "SS01", "SS04", "SS06", "PR01", "PR02", "PR03", "PR04", "PR07", "PR10", "RT01", "RT03"}
LONGEST_FILE = 600
LONGEST_BODY = 60


def modules():
    for info in pkgutil.walk_packages(aureole.__path__, "aureole."):
        if info.name.split(".")[-1] not in {"__main__"}:
            yield importlib.import_module(info.name)


def public_names():
    seen = set()
    for module in modules():
        private = any(part.startswith("_") for part in module.__name__.split("."))
        for name, value in vars(module).items():
            if name.startswith("_") or private or getattr(value, "__module__", None) != module.__name__:
                continue
            if inspect.isfunction(value) or inspect.isclass(value):
                seen.add(f"{module.__name__}.{name}")
    return sorted(seen)


@pytest.mark.parametrize("name", public_names())
def test_docstring_contract(name):
    # A command's docstring is its --help, and its parameters are documented in their options.
    kept = KEPT - {"PR01", "PR02", "RT01", "SS06"} if name.startswith("aureole.cli.") else KEPT
    errors = [(code, text) for code, text in validate(name)["errors"] if code in kept]
    assert not errors


@pytest.mark.parametrize("module", list(modules()), ids=lambda module: module.__name__)
def test_every_module_says_what_it_is_for(module):
    assert module.__doc__
    assert len(module.__doc__.strip()) > 20


def test_files_and_functions_stay_short():
    import ast

    long = []
    for path in pathlib.Path(aureole.__file__).parent.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if text.count("\n") > LONGEST_FILE:
            long.append(f"{path.name}: {text.count(chr(10))} lines")
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef):
                doc = node.body[0].end_lineno - node.body[0].lineno + 1 if ast.get_docstring(node) else 0
                if node.end_lineno - node.lineno - doc > LONGEST_BODY:
                    long.append(f"{path.name}:{node.name}")
    assert not long, long
