# make demo   install, generate a walk, validate it in every installed physics engine, plot it and
#             write a page that shows the moving robot
# make test   check style and types, then run the tests without the longest simulations
# make docs   build the documentation site in the folder site
# make test-all, make lint, make bench, make gallery, make docs-figures, make clean

PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
DEMO := outputs/demo
# One process per processor core. Each takes over a stretch of the tests, so that neighbours share
# what they need; whoever is done first helps the others. OpenBLAS takes one thread in each, as in the
# command mgs: more would wait for each other.
PYTEST := OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -q -n auto --dist worksteal

.PHONY: demo test test-all lint docs bench gallery docs-figures clean

demo: $(VENV)/.mgs
	@mkdir -p $(DEMO)
	$(BIN)/mgs generate melson/walk_5cm -o $(DEMO)/walk_5cm.mcap --force
	$(BIN)/mgs validate $(DEMO)/walk_5cm.mcap
	$(BIN)/mgs plot $(DEMO)/walk_5cm.mcap -o $(DEMO)/plots --force
	@$(BIN)/mgs info $(DEMO)/walk_5cm.mcap | grep -E '^engines:|MISSING'
	$(BIN)/mgs report $(DEMO)/walk_5cm.mcap -o $(DEMO)/walk_5cm.html --replay mujoco --force
	@echo "motion: $(DEMO)/walk_5cm.mcap   plots: $(DEMO)/plots"
	@echo "page:   $(CURDIR)/$(DEMO)/walk_5cm.html (open it in a web browser)"

test: lint
	$(PYTEST) -m "not slow"

test-all: lint
	$(PYTEST) --hypothesis-profile thorough

lint: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

docs: $(VENV)/.dev
	$(BIN)/mkdocs build --strict

bench: $(VENV)/.mgs
	$(BIN)/python benchmarks/run.py

gallery: $(VENV)/.mgs
	$(BIN)/python benchmarks/gallery.py

docs-figures: $(VENV)/.mgs
	$(BIN)/python -c "from pathlib import Path; from mgs.gait import load_gait; \
	from mgs.pipeline import run_stages; from mgs.report import write_picture; \
	from mgs.robot import load_robot; \
	walk = run_stages(load_robot('melson'), load_gait('melson/walk_practical')).motion; \
	write_picture(walk, Path('docs/walk.png'), force=True)"

$(VENV)/.mgs: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade pip
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e .
	@touch $@

$(VENV)/.dev: $(VENV)/.mgs
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[dev]"
	@touch $@

clean:
	rm -rf $(VENV) build dist site .mypy_cache .pytest_cache .ruff_cache .hypothesis
