# `make play` and `make test` are all that most people need; both set up what is missing first.
.NOTPARALLEL:
.PHONY: help play test check docs test-slow bench setup peers maps pictures stress attack long-run fuzz lock audit lowest size

BIN := .venv/bin
# Where the environment forbids Python to keep what it compiles, each program that tests start would compile all of it.
export PYTHONDONTWRITEBYTECODE =

help: ## This list.
	@grep -E '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  make \1\t\2/' | expand -t 20

play: setup ## Start a game on this machine; more options with ARGS="...", e.g. ARGS="--help".
	$(BIN)/thbridge play $(ARGS)

test: setup peers ## All checks, and all tests that are quick; what each kind takes is added to durations.csv.
	@began=$$(date +%s); checked=0; \
	$(BIN)/python -m tests.support.programs.compiling & \
	make --no-print-directory check || checked=$$?; \
	wait $$! && [ $$checked = 0 ] && \
	CHECKED_SECONDS=$$(($$(date +%s) - began)) $(BIN)/pytest -n auto --dist loadfile --max-worker-restart=0

check: setup ## Style, types, and that no import points back.
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

test-slow: setup peers ## The tests that take their time, and all properties with 300 examples.
	$(BIN)/pytest -m slow
	$(BIN)/pytest -m "hypothesis and not slow" --hypothesis-profile thorough -n auto

# What is over its budget is measured up to twice more: a machine has slow minutes, a slow kernel is slow in all of them.
AGAIN = $(BIN)/pytest -m bench -s --last-failed --last-failed-no-failures none
bench: setup ## Speed, held against tests/bench/budgets.toml; ARGS="--write-budgets" raises it.
	$(BIN)/pytest -m bench -s $(ARGS) || $(AGAIN) || $(AGAIN)

stress: setup ## Play hundreds of random hunts on all cores; more with ARGS="--help".
	$(BIN)/python scripts/stress_hunts.py $(ARGS)

attack: setup ## Attack a session on this machine at all its doors, and tell how it held; more with ARGS="--help".
	$(BIN)/python scripts/attack.py $(ARGS)

long-run: setup ## Run a session for a simulated day with everybody connected, and tell what grows; hours; ARGS="session --help".
	$(BIN)/python scripts/long_run.py $(or $(ARGS),session)

fuzz: setup ## Read thousands of damaged files with every parser; more with ARGS="--help".
	$(BIN)/python -m tests.fuzz $(ARGS)

docs: setup ## Build the site of the documentation into site/; open the file that it names in a browser.
	$(BIN)/python -m scripts.site.build $(ARGS)

size: setup ## Print the product's modules and lines for each feature.
	$(BIN)/python scripts/count_lines.py

setup: ## Make .venv from requirements.lock; does nothing when it is up to date.
	@scripts/set_up.sh

peers: setup ## Install what tests/peers plays against: MAVLink clients, ROS tools, Java, R (the latter three as root).
	@scripts/install_peers.sh

maps: setup ## Draw the maps that come with the project anew.
	$(BIN)/python scripts/draw/maps.py

pictures: setup ## Draw the windows for docs/reference/windows-gallery.md anew.
	$(BIN)/python scripts/draw/windows.py $(ARGS)

# What requirements.lock holds: all extras, and what tests and checks need.
WANTED = pyproject.toml $(addprefix --extra ,gui argumentation cluster learning markers foxglove) --group dev --python-version 3.11

lock: setup ## Pin the dependencies of pyproject.toml again; existing pins stay where they can.
	$(BIN)/uv pip compile $(WANTED) --generate-hashes --no-emit-index-url --no-emit-find-links -o requirements.lock

LOWEST := .venv-lowest
lowest: setup ## Run the quick tests with the lowest versions that pyproject.toml allows; some of them with ARGS="tests/ui -x".
	$(BIN)/uv venv -q --clear --python $(BIN)/python $(LOWEST)
	$(BIN)/uv pip compile -q $(WANTED) --resolution lowest-direct -o $(LOWEST)/requirements.txt
	$(BIN)/uv pip install -q --python $(LOWEST)/bin/python -r $(LOWEST)/requirements.txt
	$(BIN)/uv pip install -q --python $(LOWEST)/bin/python --no-deps --no-build-isolation -e .
	$(LOWEST)/bin/pytest -n auto --dist loadfile $(ARGS)

audit: setup ## Check requirements.lock against known faults; DB=FOLDER of advisories in OSV's format, else PyPA's are fetched.
	$(BIN)/python scripts/audit_lock.py $(ARGS) $(DB)
