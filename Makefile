# The newest of these Pythons that runs here and can make environments; `make PYTHON=...` names another.
VERSIONS := 3.13 3.12 3.11
FITS := import sys, venv, ensurepip; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))
PYTHON ?= $(eval PYTHON := $(shell for python in $(VERSIONS:%=python%) python3; do \
  $$python -c '$(FITS)' 2>/dev/null && echo $$python && break; done))$(PYTHON)
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
MISSION ?= missions/first_traverse.yaml
# Warnings of pip (of a mirror, of a cache) say nothing about this project; its errors do come through.
PIP := $(BIN)/python -m pip --quiet --quiet --disable-pip-version-check
SAY := @printf 'longarm: %s\n'
# Where modules may not be kept compiled, every process compiles all of them anew, and takes twice as long to start.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: run test lint types imports check wheel lock clean
.DEFAULT_GOAL := run

run: $(STAMP)  ## the first mission, from a fresh machine to the report it wrote
	$(SAY) "running $(MISSION), with a report at the end"
	@$(BIN)/longarm run $(MISSION)

test: $(STAMP)  ## the whole test suite
	$(BIN)/python -m pytest -n 2 --dist worksteal

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(STAMP)
	$(BIN)/mypy

imports: $(STAMP)
	$(BIN)/lint-imports

check: lint types imports test  ## everything a change must pass

# What setuptools leaves behind would get into the next wheel, and hide the entry points of the checkout.
wheel: $(STAMP)  ## the wheel, in dist/
	@rm -rf build dist *.egg-info
	@$(PIP) wheel --no-deps --no-build-isolation --wheel-dir dist .
	@rm -rf build *.egg-info
	@ls dist/*.whl

lock: $(STAMP)  ## requirements.lock anew from pyproject.toml, with what is in it already where that fits
	@$(PYTHON) -m venv build/lock && build/lock/bin/python -m pip --quiet --quiet install uv
	build/lock/bin/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
	  --extra dask --group dev --custom-compile-command "make lock" --output-file requirements.lock pyproject.toml

clean:
	rm -rf $(VENV) build dist *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# The lock holds every package in the version it was tested with, by hash; the project itself is added to it,
# editable, without letting pip resolve anything anew.
$(STAMP): requirements.lock pyproject.toml setup.py
	@test -n "$(PYTHON)" || { \
	  echo "longarm needs Python 3.13, 3.12 or 3.11 with its venv module, and finds none."; \
	  echo "Install one (Debian, Ubuntu: apt install python3 python3-venv), or name it: make PYTHON=/path/to/python3"; \
	  exit 2; }
	@$(PYTHON) -c '$(FITS)' 2>/dev/null || { \
	  echo "longarm needs Python 3.11 to 3.13 with its venv module; $(PYTHON) is not that:"; \
	  $(PYTHON) --version; $(PYTHON) -c 'import venv, ensurepip'; exit 2; }
	$(SAY) "first use, with $$($(PYTHON) --version) ($(PYTHON)); some 3 minutes until it is ready"
	$(SAY) "1 of 3: making the environment $(VENV)"
	@$(PYTHON) -m venv --clear $(VENV)
	$(SAY) "2 of 3: installing $$(grep -c == requirements.lock) packages, checked by hash: about 2 minutes"
	@$(PIP) install --require-hashes --requirement requirements.lock
	@rm -rf build *.egg-info
	@$(PIP) install --no-deps --no-build-isolation --editable .
	$(SAY) "3 of 3: compiling the inner loops of perception, once: about a minute"
	@$(BIN)/python -m perception.localizer.machine_code
	$(SAY) "ready: $(BIN)/longarm, or 'longarm' after 'source $(BIN)/activate'"
	@touch $@
