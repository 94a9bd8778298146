# make demo: the main job on the bundled scene.  make test: everything that is tested.
# make figures: the pictures of docs/far-field.md.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin

.PHONY: demo test figures check clean

demo: $(VENV)/.installed
	@$(BIN)/aureole demo

figures: $(VENV)/.installed
	@AUREOLE=$(BIN)/aureole sh docs/figures.sh

test: $(VENV)/.tests-installed check
	$(BIN)/python -m pytest

check: $(VENV)/.tests-installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/.installed: pyproject.toml $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

$(VENV)/.tests-installed: pyproject.toml $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --requirement tests/requirements.txt
	@touch $@

clean:
	rm -rf $(VENV) build dist .mypy_cache .ruff_cache .pytest_cache
