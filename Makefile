# PyBullet ships wheels for CPython up to 3.11 only, so the interpreter is chosen here, explicitly.
PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
MISSION ?= missions/first_traverse.yaml

.PHONY: run test lint types imports check clean
.DEFAULT_GOAL := run

run: $(STAMP)  ## the first mission, from a fresh machine to the report it wrote
	$(BIN)/longarm run $(MISSION)

test: $(STAMP)  ## the whole test suite
	$(BIN)/python -m pytest -n 2

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(STAMP)
	$(BIN)/mypy

imports: $(STAMP)
	$(BIN)/lint-imports

check: lint types imports test  ## everything a change must pass

clean:
	rm -rf $(VENV) build dist *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# The lock holds every package in the version it was tested with; the project itself is added to it,
# editable, without letting pip resolve anything anew.
$(STAMP): requirements.lock pyproject.toml
	@command -v $(PYTHON) >/dev/null || { \
	  echo "longarm needs $(PYTHON): PyBullet has no wheels for later versions of Python."; \
	  echo "Install Python 3.11 (with its venv module), or name it: make $(or $(MAKECMDGOALS),run) PYTHON=/path/to/python3.11"; \
	  exit 2; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' || { \
	  echo "longarm needs Python 3.11, got $$($(PYTHON) --version): PyBullet has wheels up to 3.11 only."; exit 2; }
	$(PYTHON) -m venv --clear $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --requirement requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@touch $@
