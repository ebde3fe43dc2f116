# The two commands of a newcomer: `make demo` and `make test`.
PYTHON ?= python3
ifeq ($(OS),Windows_NT)
BIN := .venv/Scripts
else
BIN := .venv/bin
endif
INSTALL := $(BIN)/python -m pip install --disable-pip-version-check --quiet --constraint constraints.txt

.DEFAULT_GOAL := demo
.PHONY: demo setup test test-all test-rest campaign campaign-tenth check check-format check-lint check-licences links check-floors check-types licences audit docs package bench bench-tracking bench-photographs reproduce recordings assets pictures cast clean

demo: .venv/ready  ## set everything up and play
	$(BIN)/cubeling demo

setup: .venv/ready-dev  ## install what those who change the program need; CONTRIBUTING.md goes on from here

# The tests of a file run in one process, as they share fixtures that take long to make. Byte code is kept even where the
# environment says otherwise, or each process that a test starts compiles the program again.
PYTEST := PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest --numprocesses auto --dist loadfile

test: .venv/ready-dev  ## test all rooms, on all cores
	$(PYTEST) -m "not full"

test-all: .venv/ready-dev  ## the same, and what checks bundled files, benchmarks and planted faults, with all of Hypothesis' examples
	$(PYTEST) --hypothesis-profile full

test-rest: .venv/ready-dev  ## what `make test-all` does beyond `make test`
	$(PYTEST) --hypothesis-profile full -m "full or hypothesis"

# The campaigns run for longer than a test suite may take, over random faults in virtual time.
campaign: .venv/ready-dev  ## the long runs: exchanges with robots, planted faults, damaged files, kills, cameras, blocks of BML, pictures for the tracker, hours of play and drawing
	$(BIN)/python -m tests.campaigns.wire --exchanges 1e6
	$(BIN)/python -m tests.campaigns.crc
	$(BIN)/python -m tests.campaigns.mutants
	$(BIN)/python -m tests.campaigns.soak --hours 24
	$(BIN)/python -m tests.campaigns.afternoon
	$(BIN)/python -m tests.campaigns.behaviour
	$(BIN)/python -m tests.campaigns.growth
	$(BIN)/python -m tests.campaigns.server
	$(BIN)/python -m tests.campaigns.drawing
	$(BIN)/python -m tests.campaigns.cast
	$(BIN)/python -m tests.campaigns.talk
	$(BIN)/python -m tests.campaigns.files --files 1e5
	$(BIN)/python -m tests.campaigns.kills
	$(BIN)/python -m tests.campaigns.study_kills
	$(BIN)/python -m tests.campaigns.camera_faults
	$(BIN)/python -m tests.campaigns.long_play --hours 10
	$(BIN)/python -m tests.campaigns.long_play --minutes 30
	$(BIN)/python -m tests.campaigns.tracker
	$(BIN)/python -m tests.campaigns.two_cubes
	$(BIN)/python -m tests.campaigns.browser

campaign-tenth: .venv/ready-dev  ## a tenth of the campaign, for every change
	$(BIN)/python -m tests.campaigns.wire --exchanges 1e5
	$(BIN)/python -m tests.campaigns.crc --random 1.2e5 --trials 1e6
	$(BIN)/python -m tests.campaigns.mutants --every 10
	$(BIN)/python -m tests.campaigns.soak --hours 2.4
	$(BIN)/python -m tests.campaigns.afternoon --scenes "every key" "record and replay"
	$(BIN)/python -m tests.campaigns.behaviour --blocks 10000
	$(BIN)/python -m tests.campaigns.growth --steps 3
	$(BIN)/python -m tests.campaigns.server --short --seconds 1
	$(BIN)/python -m tests.campaigns.drawing --minutes 1
	$(BIN)/python -m tests.campaigns.cast --minutes 1
	$(BIN)/python -m tests.campaigns.talk --turns 1e4
	$(BIN)/python -m tests.campaigns.files --files 1e4
	$(BIN)/python -m tests.campaigns.kills --kills 10
	$(BIN)/python -m tests.campaigns.study_kills --kills 1
	$(BIN)/python -m tests.campaigns.camera_faults --faults stall "huge header"
	$(BIN)/python -m tests.campaigns.long_play --hours 0.1
	$(BIN)/python -m tests.campaigns.tracker --frames 1200
	$(BIN)/python -m tests.campaigns.two_cubes --clips 100

# pre-commit runs the parts, each where it has something to check.
check: check-format check-lint check-licences check-floors check-types  ## check formatting, lint, docstrings, licences, the floors of the rooms, and types

check-format: .venv/ready-dev
	$(BIN)/ruff format --check .

check-lint: .venv/ready-dev
	$(BIN)/ruff check .
	$(BIN)/python -m tools.docstring_check

check-licences: .venv/ready-dev
	$(BIN)/python -m tools.licences --check

links: .venv/ready-dev
	$(BIN)/python -m tools.package_links

check-floors: links
	cd build/packages && ../../$(BIN)/lint-imports --config ../../.importlinter --cache-dir ../../.import_linter_cache

check-types: links
	$(BIN)/mypy

# In an environment of its own: it needs every extra, and tests must not depend on what they add.
licences:  ## write the table of docs/licences.md again
	$(PYTHON) -m venv build/licences
	build/licences/$(notdir $(BIN))/python -m pip install --quiet --constraint constraints.txt --editable ".[align,fbx,lab,osc,plots,sound,study,voice,web]"
	build/licences/$(notdir $(BIN))/python -m tools.licences

audit: .venv/ready-audit  ## ask which versions in constraints.txt have known vulnerabilities
	$(BIN)/python -m tools.audit

docs: .venv/ready-dev  ## make the site of the guides and of the public names in build/docs, and check its links
	$(BIN)/python -m tools.site

package: .venv/ready-dev  ## build what is published, and try it in a fresh environment, beside Robot Framework
	$(BIN)/python -m tools.package_check

bench: .venv/ready-dev  ## measure every figure that the documents name
	-$(BIN)/python -m tests.bench.start
	$(BIN)/python -m tests.bench.line
	$(BIN)/python -m tests.bench.accuracy
	$(BIN)/python -m tests.bench.codecs
	$(BIN)/python -m tests.bench.video_codecs
	$(BIN)/python -m tests.bench.recording
	-$(BIN)/python -m tests.bench.animation
	-$(BIN)/python -m tests.bench.cast_picture
	$(BIN)/python -m tests.bench.mocap
	$(BIN)/python -m tests.bench.retarget
	$(BIN)/python -m tests.bench.motion_graphs --choices 6
	$(BIN)/python -m tests.bench.loading
	$(BIN)/python -m tests.bench.feet
	$(BIN)/python -m tests.bench.matching
	$(BIN)/python -m tests.bench.controllers
	$(BIN)/python -m tests.bench.coherence
	$(BIN)/python -m tests.bench.idle
	$(BIN)/python -m tests.bench.idle_study
	$(BIN)/python -m tests.bench.stimulus_onset
	$(BIN)/python -m tests.bench.standing
	$(BIN)/python -m tests.bench.postures
	$(BIN)/python -m tests.bench.upper_body
	$(BIN)/python -m tests.bench.pitch
	$(BIN)/python -m tests.bench.alignment
	$(BIN)/python -m tests.bench.accents
	$(BIN)/python -m tests.bench.gestures
	$(BIN)/python -m tests.bench.face
	$(BIN)/python -m tests.bench.speaking
	$(BIN)/python -m tests.bench.ik
	$(BIN)/python -m tests.bench.reach
	$(BIN)/python -m tests.bench.springs
	$(BIN)/python -m tests.bench.cast
	-$(BIN)/python -m tests.bench.strangers ../shared/data
	$(BIN)/python -m tests.bench.symbolic_gestures
	$(BIN)/python -m tests.bench.expressivity
	$(BIN)/python -m tests.bench.bml
	$(BIN)/python -m tests.bench.picture
	$(BIN)/python -m tests.bench.wrinkles
	$(BIN)/python -m tests.bench.effects
	$(BIN)/python -m tests.bench.soft_shadows
	$(BIN)/python -m tests.bench.detail
	$(BIN)/python -m tests.bench.in_the_cube
	-$(BIN)/python -m tests.bench.hand_mask
	-$(BIN)/python -m tests.bench.cube_light --rooms 2
	-$(BIN)/python -m tests.bench.ambient_occlusion
	$(BIN)/python -m tests.bench.panels
	$(BIN)/python -m tests.bench.looks
	$(BIN)/python -m tests.bench.wire
	$(BIN)/python -m tests.bench.peers
	$(BIN)/python -m tests.bench.instruments
	$(BIN)/python -m tests.bench.vmc
	$(BIN)/python -m tests.bench.several
	$(BIN)/python -m tests.bench.camera
	$(BIN)/python -m tests.bench.ahead
	$(BIN)/python -m tests.bench.calibration --seeds 2

bench-tracking: .venv/ready-dev  ## compare the cube's tracker with others on the same frames
	$(BIN)/python -m tests.bench.tracking --readme tracking/README.md

bench-photographs: .venv/ready-dev  ## compare the cube's tracker with OpenCV on photographs, follow them as one sequence, and find the hand on them
	$(BIN)/python -m tests.bench.photographs
	$(BIN)/python -m tests.bench.photographs.sequence
	$(BIN)/python -m tests.bench.photographs.hands

reproduce: .venv/ready-dev  ## the printed tables and figures of the theses, made again into out/report/; minutes
	mkdir -p out
	$(BIN)/cubeling reproduce $(if $(wildcard ../shared/data),--data ../shared/data) -o out/report --overwrite

recordings: .venv/ready-dev  ## record the bundled sessions again
	$(BIN)/python -m tools.recordings

assets: .venv/ready-dev  ## make the bundled characters again
	$(BIN)/python -m tools.authoring all

pictures: .venv/ready-dev  ## draw the pictures of the documents again
	$(BIN)/python -m tools.pictures
	$(BIN)/python -m tools.realism
	$(BIN)/python -m tools.effects
	$(BIN)/python -m tools.in_the_cube
	$(BIN)/python -m tools.skin_sheet
	$(BIN)/python -m tests.bench.ambient_occlusion.picture
	$(BIN)/python -m tools.sound_sheet
	$(BIN)/python -m tools.face_sheet
	$(BIN)/python -m tools.wiring
	$(BIN)/python -m tests.robot.conformance.picture

cast: .venv/ready  ## draw the bundled characters from all sides, and their clips
	$(BIN)/python -m tools.cast

.venv/ready: pyproject.toml constraints.txt
	$(PYTHON) -c "import sys; sys.exit(sys.version_info < (3, 11) and 'Cubeling needs Python 3.11 or newer; choose one with: make PYTHON=python3.12')"
	$(PYTHON) -m venv .venv
	@echo "Installing what Cubeling needs into .venv (once, about a minute) …"
	$(INSTALL) --editable .
	@touch $@

.venv/ready-dev: .venv/ready
	$(INSTALL) --editable ".[dev]"
	@touch $@

.venv/ready-audit: .venv/ready-dev
	$(INSTALL) --editable ".[audit]"
	@touch $@

clean:
	rm -rf .venv .bench build *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
