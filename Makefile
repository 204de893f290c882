# One virtual environment, .venv, serves every target; nothing else has to be installed or typed first.
# Another interpreter: make install PYTHON=python3.12. More for pytest: make test PYTEST_ARGS="-x tests/io".

PYTHON ?= python3
PYTEST_ARGS ?=
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip install -qq --disable-pip-version-check -c constraints.txt
INSTALLED := $(VENV)/.installed
DEVELOPING := $(VENV)/.developing

.DEFAULT_GOAL := help
.PHONY: help install extras demo test cluster lint tree docs bench wheel bare clean

help: ## show this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-8s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

install: $(INSTALLED) ## the command, in .venv
	@echo "ready: $(BIN)/weingarten --help"

extras: $(INSTALLED) ## what bench, report, reproduce and --simplify need beside it
	@$(PIP) -e ".[bench,report,simplify]"

demo: $(INSTALLED) ## points of a bundled flange to a mesh, a picture and its errors, in demo/
	@mkdir -p demo && rm -rf demo/run
	@$(BIN)/weingarten sample bundled:flange -o demo/flange.ply
	@$(BIN)/weingarten fit demo/flange.ply -o demo/flange.stl --run demo/run --picture demo/flange.png
	@$(BIN)/weingarten evaluate demo/flange.stl bundled:flange

test: $(DEVELOPING) ## the tests
	@$(BIN)/python -m pytest -n auto --maxprocesses 8 --dist worksteal $(PYTEST_ARGS)

cluster: $(DEVELOPING) ## the tests with a Ray cluster, of which a machine is killed; installs Ray
	@$(PIP) -e ".[ray]"
	@$(BIN)/python -m pytest tests/many $(PYTEST_ARGS)

lint: $(DEVELOPING) ## style, types, and whether README.md lists the files there are
	@$(BIN)/ruff check --quiet
	@$(BIN)/ruff format --check --quiet
	@$(BIN)/pyright --pythonpath $(BIN)/python
	@$(BIN)/python docs/file_tree.py --check

tree: $(DEVELOPING) ## write the file tree in README.md anew, from the modules' docstrings
	@$(BIN)/python docs/file_tree.py

docs: $(DEVELOPING) ## the documentation, in site/; open site/index.html
	@NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict

bench: $(INSTALLED) ## seconds, memory and time to quality, as one page: results/performance.md
	@$(BIN)/python benchmarks -o results/performance.md

wheel: $(DEVELOPING) ## the source archive and the wheel, in dist/, and a trial of the wheel without extras
	@rm -rf build dist && $(BIN)/python -m build --no-isolation >/dev/null
	@$(BIN)/python -m pytest tests/packaging

bare: wheel ## the same trial in build/bare, where nothing is but the wheel and what it requires
	@$(PYTHON) -m venv build/bare
	@build/bare/bin/python -m pip install -qq --disable-pip-version-check -c constraints.txt dist/*.whl
	@$(BIN)/python -m pytest tests/packaging/test_wheel.py --installed build/bare/bin/python

clean: ## remove what was made, but not .venv
	@rm -rf demo build dist site .pytest_cache .ruff_cache .hypothesis
	@find src tests benchmarks runs docs -name __pycache__ -type d -prune -exec rm -rf {} +

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || { \
	  echo "weingarten needs Python 3.11 or newer; name one with PYTHON=python3.12, for example."; exit 1; }
	@$(PYTHON) -m venv $(VENV)

$(INSTALLED): pyproject.toml constraints.txt | $(BIN)/python
	@echo "installing into $(VENV); a few minutes the first time"
	@$(PIP) -e .
	@touch $@

$(DEVELOPING): $(INSTALLED)
	@echo "installing what the tests and checks need"
	@$(PIP) -e ".[dev]"
	@touch $@
