# make demo: the main job on the bundled scene.  make test: everything that is tested.
# make figures: the pictures of docs/.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin

.PHONY: demo test figures check stale clean

demo: $(VENV)/.installed stale
	@$(BIN)/aureole demo

figures: $(VENV)/.installed stale
	@AUREOLE=$(BIN)/aureole sh docs/figures.sh
	@AUREOLE=$(BIN)/aureole PYTHON=$(BIN)/python sh docs/near_figures.sh
	@AUREOLE=$(BIN)/aureole PYTHON=$(BIN)/python sh docs/flare_figures.sh
	@PYTHON=$(BIN)/python sh docs/eye_figures.sh
	@PYTHON=$(BIN)/python sh docs/surface_figures.sh
	@AUREOLE=$(BIN)/aureole PYTHON=$(BIN)/python sh docs/sequence_figures.sh

test: $(VENV)/.tests-installed check stale
	$(BIN)/python -m pytest

check: $(VENV)/.tests-installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# Compiled loops are kept beside their sources, each by its own source's date alone; one that calls into
# another file is not made anew when that one changes. So all that is older than the newest source goes.
stale:
	@newest=$$(ls -t $$(find src -name '_kernels*.py') | head -n 1); \
	find src -name '*.nb[ic]' ! -newer "$$newest" -delete

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
