# Most people need only `make play` and `make test`; both first install what is missing.
.NOTPARALLEL:
.PHONY: help play test check docs test-slow bench setup peers maps pictures stress attack long-run fuzz lock audit lowest size

BIN := .venv/bin
# If the environment forbids Python to keep compiled code, each program that tests start would compile everything again.
export PYTHONDONTWRITEBYTECODE =

help: ## Show this list.
	@grep -E '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  make \1\t\2/' | expand -t 20

play: setup ## Start a game on this machine; pass options with ARGS="...", for example ARGS="--help".
	$(BIN)/thbridge play $(ARGS)

test: setup peers ## Run all checks and all quick tests; append the durations to durations.csv.
	@began=$$(date +%s); checked=0; \
	$(BIN)/python -m tests.support.programs.compiling & \
	make --no-print-directory check || checked=$$?; \
	wait $$! && [ $$checked = 0 ] && \
	CHECKED_SECONDS=$$(($$(date +%s) - began)) $(BIN)/pytest -n auto --dist loadfile --max-worker-restart=0

check: setup ## Check style, types, and the direction of imports.
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

test-slow: setup peers ## Run the slow tests, and all properties with 300 examples each.
	$(BIN)/pytest -m slow
	$(BIN)/pytest -m "hypothesis and not slow" --hypothesis-profile thorough -n auto

# Measure again, up to twice, what exceeds its budget: a machine is slow for some minutes, but a slow kernel is always slow.
AGAIN = $(BIN)/pytest -m bench -s --last-failed --last-failed-no-failures none
bench: setup ## Compare speed with tests/bench/budgets.toml; ARGS="--write-budgets" raises the budgets.
	$(BIN)/pytest -m bench -s $(ARGS) || $(AGAIN) || $(AGAIN)

stress: setup ## Play hundreds of random hunts on all cores; for options, use ARGS="--help".
	$(BIN)/python scripts/stress_hunts.py $(ARGS)

attack: setup ## Attack all ports of a session on this machine, and report the results; for options, use ARGS="--help".
	$(BIN)/python scripts/attack.py $(ARGS)

long-run: setup ## Run a session for a simulated day with all kinds of clients, and report what grows (takes hours); ARGS="session --help".
	$(BIN)/python scripts/long_run.py $(or $(ARGS),session)

fuzz: setup ## Read thousands of damaged files with every parser; for options, use ARGS="--help".
	$(BIN)/python -m tests.fuzz $(ARGS)

docs: setup ## Build the site of the documentation into site/; open the file that it names in a browser.
	$(BIN)/python -m scripts.site.build $(ARGS)

size: setup ## Print the product's modules and lines for each feature.
	$(BIN)/python scripts/count_lines.py

setup: ## Create .venv from requirements.lock; does nothing if it is up to date.
	@scripts/set_up.sh

peers: setup ## Install the programs for tests/peers: MAVLink clients, ROS tools, Java, R (the last three as root).
	@scripts/install_peers.sh

maps: setup ## Draw the maps of the project again.
	$(BIN)/python scripts/draw/maps.py

pictures: setup ## Draw the windows and the pages of the browser for the galleries in docs/reference again.
	$(BIN)/python scripts/draw/windows.py $(ARGS)
	if [ -x /usr/bin/chromium ]; then $(BIN)/python scripts/draw/pages.py; fi

# Contents of requirements.lock: all extras, and the packages for tests and checks.
WANTED = pyproject.toml $(addprefix --extra ,gui web argumentation cluster learning markers foxglove ros2) --group dev --python-version 3.11

lock: setup ## Pin the dependencies of pyproject.toml again; existing pins are kept if possible.
	$(BIN)/uv pip compile $(WANTED) --generate-hashes --no-emit-index-url --no-emit-find-links -o requirements.lock

LOWEST := .venv-lowest
lowest: setup ## Run the quick tests with the lowest versions that pyproject.toml allows; select tests with ARGS="tests/ui -x".
	$(BIN)/uv venv -q --clear --seed --python $(BIN)/python $(LOWEST)
	$(BIN)/uv pip compile -q $(WANTED) --resolution lowest-direct -o $(LOWEST)/requirements.txt
	$(BIN)/uv pip install -q --python $(LOWEST)/bin/python -r $(LOWEST)/requirements.txt
	$(BIN)/uv pip install -q --python $(LOWEST)/bin/python --no-deps --no-build-isolation -e .
	$(LOWEST)/bin/pytest -n auto --dist loadfile $(ARGS)

audit: setup ## Check requirements.lock against known vulnerabilities; DB=FOLDER has advisories in OSV's format (default: fetch PyPA's).
	$(BIN)/python scripts/audit_lock.py $(ARGS) $(DB)
