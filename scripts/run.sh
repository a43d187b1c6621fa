#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Installs what is missing, builds what has changed, and runs the sail, the tests or the formatters.
set -euo pipefail

usage() {
    sed "s,scripts/run.sh,$me,; ${installed:+/^In the folder/,/^END/d}" <<'END'
usage: scripts/run.sh COMMAND [options]

  deploy [-j N] [options]   fold, spin up and deploy the sail, on N threads (default 1);
                            options of scripts/deploy.py, listed by `scripts/run.sh deploy --help`
  report FOLDER ...         write report.html again from the other results in an output folder
  animate FOLDER ...        render sail.mp4 and sail.gif from the shapes in an output folder
  sail FILE [options]       spin any sail: a crease pattern (.fold) or a mesh of gmsh (.msh);
                            options of scripts/sail.py
  miura [options]           a Miura-ori sheet from a FOLD file, unfolded by tip masses
  watch [-j N] [options]    deploy the sail in YADE's own window; close the window to end
  sweep [SAIL] [options]    run the paper's Table 2, or a grid over any parameters of any sail, by
                            Snakemake, here (-j N cores) or on Slurm (--slurm), and report into
                            out/sweep; run again, it goes on where it was stopped; options by
                            `scripts/run.sh sweep --help`; sweep report DIR only reports
  case --out DIR [options]  one deployment that leaves all its results or none and, run again
                            after it was stopped, goes on; options by `scripts/run.sh case --help`
  ikaros [options]          stage 2 of the flight sail on a free hub; options of scripts/ikaros.py
  disk [--out DIR]          accuracy: a spinning disk against its closed form
  calibrate TARGET [options]
                            find the alpha_crease and beta whose run follows a measured curve;
                            options of scripts/calibrate.py
  help                      print this

In the folder of the sources also:

  test [-j N] [--full | --quick] [--coverage] [MODULE ...]
                            run the tests, or those of some modules; --full adds the long ones,
                            --quick keeps to those that need no scene, less than a minute;
                            --coverage, and --full, tell what of the package ran meanwhile
  check                     a short test: build, load, check the layout, deploy on both paths, save
                            and load, package
  bench [options]           measure the speed beside YADE's own functors and LAMMPS: tables, and
                            reference/bench.json; options of scripts/bench.py
  verify [options]          hold the plugin against closed forms and an independent implementation:
                            a table, and reference/verification.json; options of scripts/verify.py
  stability [options]       scan where each part of the method fails, into reference/stability
  parts [options]           what each part of the model changes and costs, into reference/parts.csv
  chart [options]           accuracy against time for every path, step and mesh, into
                            reference/chart.csv and chart.png
  docs                      make the HTML site build/docs
  viewer                    bundle the viewer of report.html, which npm's registry holds parts of
  tidy                      hold the C++ sources against clang-tidy, as .clang-tidy has it
  sanitize                  the C++ tests under address and undefined-behaviour sanitizers, and the
                            threads under a race check
  attack [--short] [NAME ...]
                            the plugin in YADE under the same sanitizers: every class and method with
                            what fits nowhere, in scenes of every kind, and damaged saved scenes
  packages                  install what is needed to build and to run, and no more
  build                     compile the plugin into build/python
  package                   make build/package/yade-membrane_….deb, for the YADE that is here
  probe [--write]           tell how this YADE's classes differ from the nearest known release
  format [--check]          format C++ and Python sources; --check changes nothing and fails where
                            a file is not formatted, a linter complains or types do not fit;
                            options of the tools for Python are in pyproject.toml

Each command first installs the Debian packages it lacks. With --in SUITE, the code name of a Debian,
it runs in that one, which is made once, by root, in ~/.cache/yade-membrane. To start YADE by hand:
  PYTHONPATH=build/python yade my_sail.py
END
}

# Debian packages to run and to build, to mesh other sails, to verify, to compare the speed with, and to format.
# Not the VTK of python3-paraview, which excludes python3-vtk9: it and YADE's crash in one process.
run_packages=(yade python3-numpy python3-matplotlib python3-vtk9)
build_packages=(g++ cmake make libboost-dev libeigen3-dev python3-dev libglut-dev libgtest-dev)
sail_packages=(python3-gmsh)
test_packages=(xvfb xauth python3-meshio valgrind) # a display; another reader and writer of files; counts instructions
verify_packages=(python3-scipy)
bench_packages=(lammps openmpi-bin valgrind)
animation_packages=(xvfb libgl1-mesa-dri ffmpeg)
browser_packages=(chromium chromium-driver python3-selenium)
sweep_packages=(python3-jinja2 python3-yaml snakemake)
calibrate_packages=(python3-scipy)
slurm_packages=(slurmctld slurmd slurm-client munge) # for a test
coverage_packages=(python3-coverage)
docs_packages=(python3-sphinx python3-myst-parser furo libjs-mathjax)
format_packages=(clang-format black python3-flake8 mypy python3-numpy shellcheck) # numpy: its types

no_display=(-n)   # how YADE is told to do without
launch=(exec env) # how it is started: in this shell's place

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd -P)
build=$root/build
me=scripts/run.sh installed=
[[ -e $root/CMakeLists.txt ]] || me=yade-membrane installed=yes # by `package`: there is nothing to build
releases=$root/pkg/membrane/yade-abi/releases.txt
PATH=/usr/bin:/bin:$PATH # Debian's tools before any other of the same name

say() { printf '%s: %s\n' "${me##*/}" "$*" >&2; }
die() {
    say "$@"
    exit 1
}

# system NAME: what the system says of itself.
system() { sed -n "s/^$1=\"\?\([^\"]*\).*/\1/p" /etc/os-release; }

# Version of the YADE that is installed, without Debian's revision.
yade_here() { dpkg-query -W -f='${Version}' yade 2>/dev/null | sed 's/-[^-]*$//'; }

# column NAME: of releases.txt, a line each.
column() {
    awk -v name="$1" '/^# yade / { for (i = 2; i <= NF; ++i) number[$i] = i - 1 } !/^#/ { print $number[name] }' "$releases"
}

# of_release NAME: what releases.txt tells of the YADE that is here or, without one, of that which the system packages.
of_release() {
    paste <(column yade) <(column suite) <(column "$1") | awk -v yade="$(yade_here)" \
        -v suite="$(system VERSION_CODENAME)" 'yade ? $1 == yade : $2 == suite { print $3 }'
}

# Sets as_root to what must precede a command for it to run as root; fails if nothing does.
find_root() {
    if [[ $(id -u) == 0 ]]; then
        as_root=(env)
    elif ! command -v sudo >/dev/null; then
        return 1
    elif sudo -n true 2>/dev/null; then
        as_root=(sudo -n env)
    elif [[ -t 0 && -t 2 ]]; then
        as_root=(sudo env) # asks for the password
    else
        return 1
    fi
}

# need PACKAGE...: installs those that are missing and removes none.
need() {
    command -v dpkg-query >/dev/null || die "this is neither Debian nor Ubuntu: there is no dpkg-query"
    local status package log
    local -a missing=() as_root=()
    status=$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' "$@" 2>/dev/null || true)
    for package in "$@"; do
        grep -qxF "installed $package" <<<"$status" || missing+=("$package")
    done
    ((${#missing[@]})) || return 0

    local by_hand="apt-get update && apt-get install --no-install-recommends ${missing[*]}"
    find_root || die "packages are missing; as root, run: $by_hand"
    local -a apt=("${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get -qy --no-remove -o DPkg::Lock::Timeout=300)
    say "installing ${missing[*]}"
    log=$(mktemp)
    # The package lists may be absent or out of date: fetch them if the first attempt fails.
    if ! "${apt[@]}" install --no-install-recommends "${missing[@]}" >"$log" 2>&1 &&
        ! { "${apt[@]}" update && "${apt[@]}" install --no-install-recommends "${missing[@]}"; } >>"$log" 2>&1; then
        cat "$log" >&2
        rm "$log"
        die "installation failed; as root, try: $by_hand"
    fi
    rm "$log"
}

# offer PACKAGE WHAT: installs a package if the system has it; says what is left out if it has not.
offer() {
    local -a as_root=()
    # Without package lists apt does not know what there is.
    [[ -n $(apt-cache madison dpkg) ]] || { find_root && "${as_root[@]}" apt-get -q update >&2; } || true
    if dpkg-query -W "$1" >/dev/null 2>&1 || [[ -n $(apt-cache madison "$1") ]]; then
        need "$1"
    else
        say "$(system PRETTY_NAME) has no package $1: $2 is left out"
    fi
}

# configure FOLDER [options of CMake]: sets up a build folder, unless it is set up already. Begins afresh, without an
# old object, if the folder was moved here from elsewhere or is for another system or YADE.
configure() {
    local folder=$1 place kept fresh=--fresh
    place="$folder, $(system PRETTY_NAME), YADE $(of_release yade)"
    kept=$(cat "$folder/.made-for" 2>/dev/null || true)
    if [[ -e $folder/Makefile && $kept == "$place"$'\n'"${*:2}" ]]; then return; fi
    [[ ${kept%%$'\n'*} != "$place" ]] || fresh=
    rm -f "$folder/.made-for"
    cmake $fresh -S "$root" -B "$folder" -G "Unix Makefiles" "${@:2}" &&
        printf '%s\n' "$place" "${*:2}" >"$folder/.made-for"
}

configure_and_make() {
    configure "$build" -DCMAKE_BUILD_TYPE=Release && cmake --build "$build" --parallel "$(nproc)"
}

# Brings build/ up to date: silent if it is, else shows what is compiled, and on failure everything.
compile() {
    [[ -z $installed ]] || return 0
    need "${run_packages[@]}" "${build_packages[@]}"
    [[ -n $(of_release yade) ]] ||
        die "YADE $(yade_here) is none of those the plugin is for, $(column yade | xargs); scripts/run.sh probe tells how it differs"
    if ! { mkdir -p "$build" && [[ -w $build ]]; } 2>/dev/null; then
        compgen -G "$build/python/membrane/_membrane.*.so" >/dev/null || die "cannot write to $build"
        say "cannot write to $build: taking what is built there"
        return
    fi
    exec 9>"$build/.lock"
    flock 9 # one build at a time
    if ! configure_and_make 2>&1 9>&- | tee "$build/build.log" |
        { grep --line-buffered -E '^\[ *[0-9]+%\] (Building|Linking)' >&2 || true; }; then
        grep -vE '^(\[ *[0-9]+%\]|--) ' "$build/build.log" >&2 || true
        die "the build failed; everything it said is in $build/build.log"
    fi
    exec 9>&-
}

# Bundles the viewer of report.html with npm, unless it is up to date or all is installed. Ends with 1, and a word, where npm or what it
# fetches cannot be had, and with 2 where that cannot be bundled.
bundle_viewer() (
    [[ -z $installed ]] || exit 0
    source=$root/scripts/membrane/view/viewer target=$build/python/membrane/view/viewer.html work=$build/viewer
    [[ ! -e $target || -n $(find "$source" -newer "$target" -print -quit) ]] || exit 0
    command -v npm >/dev/null || (need nodejs npm) || exit 1
    mkdir -p "$work" "${target%/*}"
    exec 9>"$build/.lock"
    flock 9 # one build at a time
    cp -r "$source/." "$work"
    cd "$work"
    say "bundling the viewer of report.html"
    if ! npm ci --ignore-scripts --no-audit --no-fund --fetch-retry-mintimeout=1000 --fetch-retry-maxtimeout=3000 \
        >"$build/viewer.log" 2>&1; then
        say "npm could not fetch the viewer's parts (see $build/viewer.log); without them there is no report.html"
        exit 1
    fi
    node build.mjs "$target" || exit 2
)

# The viewer, if it can be had; all but report.html works without.
viewer_if_possible() { bundle_viewer || (($? == 1)) || die "the viewer could not be bundled"; }

# Sets HOME to a folder of this user's alone, the same each time, where the build cannot be written to.
new_home() {
    HOME=${TMPDIR:-/tmp}/membrane-home-$(id -u)
    mkdir -m 700 "$HOME" 2>/dev/null || true
    [[ -d $HOME && ! -L $HOME && -O $HOME && -w $HOME ]] || die "HOME is not set, and $HOME is no folder to write to"
}

# Sets what YADE needs to run and to find the plugin.
set_environment() {
    # YADE writes its settings below HOME, and stops without one.
    if [[ ! -w ${HOME:-/nonexistent} ]]; then
        export HOME=$build/home
        if ! { mkdir -p "$HOME" && [[ -w $HOME ]]; } 2>/dev/null; then new_home; fi
    fi
    local python=$build/python
    [[ -z $installed ]] || python=$(dirname "$(compgen -G "$root/../../lib/python3*/dist-packages/membrane")")
    export PYTHONPATH=$python${PYTHONPATH:+:$PYTHONPATH} PYTHONUNBUFFERED=1 MPLBACKEND=Agg
}

# run_yade SCRIPT [-j N] [options]: runs a script in YADE, with the other options as its sys.argv[1:].
run_yade() {
    local script=$1 threads=1
    local -a options=()
    shift
    while (($#)); do
        case $1 in
        -j)
            threads=${2-}
            shift
            ;;
        -j*) threads=${1#-j} ;;
        *) options+=("$1") ;;
        esac
        shift || true
    done
    [[ $threads =~ ^[1-9][0-9]{0,4}$ ]] || die "-j takes the number of threads, at least 1, not '$threads'"
    ((threads <= 4 * $(nproc))) || die "-j $threads: too many threads for the $(nproc) cores of this machine"
    set_environment
    # Ctrl-C waits until the script can end in one sentence; YADE itself would answer by a traceback.
    "${launch[@]}" --block-signal=INT yade "${no_display[@]}" -x -j "$threads" "$script" "${options[@]}"
}

# Has the tests, and the processes that they start, note what of the package they run, and says it when this shell ends.
measure_coverage() {
    local folder=$build/coverage
    rm -rf "$folder"
    mkdir -p "$folder/start"
    # Python imports a module of this name when it starts; sitecustomize is for a test. Another test locks the folder.
    printf '%s\n' "import os, coverage" "if os.access('$folder', os.W_OK): coverage.process_startup()" \
        >"$folder/start/usercustomize.py"
    export COVERAGE_PROCESS_START=$root/pyproject.toml COVERAGE_FILE=$folder/data PYTHONPATH=$folder/start${PYTHONPATH:+:$PYTHONPATH}
    launch=(env)
    trap report_coverage EXIT
}
report_coverage() (
    unset COVERAGE_PROCESS_START
    cd "$root"
    { python3 -m coverage combine --quiet && python3 -m coverage report; } ||
        say "test: there is no coverage to tell of"
)

run_tests() {
    # Those in C++, if any; then those in YADE, away from the caller's files.
    if [[ " $* " != *" -h "* && " $* " != *" --help "* ]] && compgen -G "$root/tests/*.cpp" >/dev/null; then
        ctest --test-dir "$build" --label-regex kernel --output-on-failure
    fi
    mkdir -p "$build/tests"
    cd "$build/tests"
    local -a options=()
    local option
    for option; do
        case $option in
        --full | --coverage) [[ ${launch[0]} == env ]] || measure_coverage ;;&
        --coverage) ;;
        *) options+=("$option") ;;
        esac
    done
    run_yade "$root/tests/run_tests.py" "${options[@]}"
}

# build_sanitized FOLDER SANITIZERS COMPILER PLUGIN TARGET...: builds with sanitizers, with the plugin if that is ON.
build_sanitized() {
    local folder=$root/$1
    mkdir -p "$folder"
    if ! {
        configure "$folder" -DMEMBRANE_PLUGIN="$4" -DMEMBRANE_SANITIZE="$2" -DCMAKE_CXX_COMPILER="$3" \
            -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS="-O1 -D_GLIBCXX_ASSERTIONS" &&
            cmake --build "$folder" --parallel "$(nproc)" --target "${@:5}"
    } >"$folder.log" 2>&1; then
        cat "$folder.log" >&2
        die "$command: the build in $folder failed"
    fi
}

# run_sanitized FOLDER SANITIZERS COMPILER TEST...: builds C++ tests with sanitizers, all if none is named, and runs them.
run_sanitized() {
    local -a tests=("${@:4}")
    build_sanitized "$1" "$2" "$3" OFF "${tests[@]:-all}"
    local IFS='|'
    ctest --test-dir "$root/$1" --label-regex kernel --tests-regex "${tests[*]:-.}" --output-on-failure
}

memory_sanitizers=address,undefined,float-cast-overflow

# Number of the LLVM that the system packages.
llvm_here() {
    of_release llvm | grep . ||
        die "$command: $(system PRETTY_NAME) is none of those whose LLVM is known: $(column suite | xargs)"
}

# The sources in a few large files, which takes an eighth of the time.
tidy() {
    local llvm folder=$root/build-tidy
    llvm=$(llvm_here)
    need "${run_packages[@]}" "${build_packages[@]}" "clang-$llvm" "clang-tidy-$llvm" "libomp-$llvm-dev"
    mkdir -p "$folder"
    configure "$folder" -DCMAKE_CXX_COMPILER="clang++-$llvm" -DCMAKE_BUILD_TYPE=Release \
        -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=15 >"$folder.log"
    # Included sources are analysed like others; lines of "N warnings generated" are left out.
    "run-clang-tidy-$llvm" -quiet -p "$folder" -j "$(nproc)" -extra-arg=-Xclang \
        -extra-arg=-analyzer-opt-analyze-headers '/membrane_(mechanics|plugin)\.dir/' >"$folder.log" 2>&1 ||
        { grep -vE '^clang-tidy|^[0-9]+ warnings' "$folder.log" >&2 && die "tidy: see above"; }
    say "tidy: nothing to mend"
}

sanitize() {
    local llvm
    llvm=$(llvm_here)
    # GCC's OpenMP is unknown to the race check, LLVM's tells it of its barriers.
    need g++ cmake make libeigen3-dev libgtest-dev "clang-$llvm" "libclang-rt-$llvm-dev" "libomp-$llvm-dev"
    UBSAN_OPTIONS=print_stacktrace=1 run_sanitized build-asan $memory_sanitizers g++
    OMP_TOOL_LIBRARIES=/usr/lib/llvm-$llvm/lib/libarcher.so \
        TSAN_OPTIONS="ignore_noninstrumented_modules=1 halt_on_error=1" \
        run_sanitized build-tsan thread "clang++-$llvm" test_Sweep test_Lanczos test_LinearForces
}

# The plugin, built with sanitizers into the folder of its C++ tests, in YADE.
attack() {
    need "${run_packages[@]}" "${build_packages[@]}"
    build=$root/build-asan
    build_sanitized build-asan $memory_sanitizers g++ ON _membrane membrane_python
    set_environment
    exec python3 "$root/tests/attacks/drive.py" "$@"
}

# List the sources of a language; build/ and hidden folders are not searched.
cpp_sources() { find "$root/pkg" "$root/scripts" "$root/tests" -name '*.[ch]pp'; }
python_sources() { find "$root/scripts" "$root/tests" "$root/reference" -name '*.py'; }

format() {
    need "${format_packages[@]}"
    local -a cpp python shell=("$root"/scripts/*.sh "$root"/scripts/packaging/* "$root/.ci/run")
    local -a black=(black -q --config "$root/pyproject.toml") flake8
    mapfile -t cpp < <(cpp_sources)
    mapfile -t python < <(python_sources)
    case ${1-} in
    '')
        clang-format -i "${cpp[@]}"
        "${black[@]}" "${python[@]}"
        ;;
    --check)
        local failed=0
        clang-format --dry-run -Werror "${cpp[@]}" || failed=1
        "${black[@]}" --check --diff "${python[@]}" || failed=1
        # flake8 does not read pyproject.toml by itself.
        mapfile -t flake8 < <(python3 -c 'import sys, tomllib
for option in tomllib.load(sys.stdin.buffer)["tool"]["flake8"].items(): print("--%s=%s" % option)' <"$root/pyproject.toml")
        python3 -m flake8 -j1 --isolated "${flake8[@]}" "${python[@]}" || failed=1
        (cd "$root" && mypy --no-error-summary) || failed=1
        shellcheck "${shell[@]}" || failed=1
        ((!failed)) || die "format: see above; scripts/run.sh format mends the layout"
        say "format: nothing to change in ${#cpp[@]} C++, ${#python[@]} Python and ${#shell[@]} shell files"
        ;;
    *) die "format: unknown option '$1'" ;;
    esac
}

# Runs the command in another Debian, if --in SUITE is among its options.
run_elsewhere() {
    local suite=
    local -a as_root=() options=()
    while (($#)); do
        if [[ $1 == --in ]]; then
            suite=${2-none}
            shift
        else
            options+=("$1")
        fi
        shift || true
    done
    [[ -n $suite ]] || return 0
    column suite | grep -qxF -- "$suite" || die "--in takes one of $(column suite | xargs), not '$suite'"
    (need debootstrap) || true
    find_root || as_root=(env)
    exec "${as_root[@]}" "$root/scripts/in_debian.sh" "$suite" "$command" "${options[@]}"
}

# list PACKAGE...: them, between commas.
list() { printf '%s, ' "$@" | sed 's/, $//'; }

# Makes build/package/yade-membrane_….deb.
package() {
    compile
    viewer_if_possible
    local yade
    yade=$(dpkg-query -W -f='${Version}' yade)
    rm -rf "$build/package"
    cpack --config "$build/CPackConfig.cmake" -B "$build/package" \
        -D CPACK_DEBIAN_PACKAGE_DEPENDS="$(list "yade (= $yade)" "${run_packages[@]:1}")" \
        -D CPACK_DEBIAN_PACKAGE_RECOMMENDS="$(list "${sail_packages[@]}" "${sweep_packages[@]}" "${calibrate_packages[@]}")" \
        -D CPACK_DEBIAN_PACKAGE_SUGGESTS="$(list "${animation_packages[@]}")" >"$build/package.log" ||
        { cat "$build/package.log" >&2 && die "package: see above"; }
    say "made $(compgen -G "$build/package/*.deb")"
}

# Installs what it takes to mesh a sail, if the options of a command name a pattern, a mesh or the Miura-ori sheet.
need_for_sail() {
    [[ $command =~ ^(sail|miura)$ || " $* " =~ \ miura\ |\.(fold|msh)\  ]] || return 0
    need "${sail_packages[@]}"
}

take_nothing() { (($# == 0)) || die "$command: unknown option '$1'"; }

command=${1-help}
shift || true
[[ -z $installed || $command =~ ^(deploy|report|animate|sail|miura|watch|sweep|case|ikaros|disk|calibrate|-?-?h(elp)?)$ ]] ||
    die "unknown command '$command', or one for the folder of the sources only; yade-membrane help lists those there are"
[[ -n $installed ]] || run_elsewhere "$@"
case $command in
deploy | sail | miura | ikaros | case)
    need_for_sail "$@"
    compile
    viewer_if_possible
    [[ " $* " != *" --animation "* ]] || need "${animation_packages[@]}"
    run_yade "$root/scripts/$command.py" "$@"
    ;;
watch)
    [[ -n ${DISPLAY-} ]] || die "watch needs a display, and DISPLAY is not set"
    need_for_sail "$@"
    compile
    no_display=()
    run_yade "$root/scripts/deploy.py" "$@" --watch
    ;;
test)
    need "${sail_packages[@]}" "${sweep_packages[@]}" "${calibrate_packages[@]}" "${test_packages[@]}"
    [[ " $* " != *" --full "* ]] || need "${slurm_packages[@]}" "${coverage_packages[@]}"
    [[ " $* " != *" --coverage "* ]] || need "${coverage_packages[@]}"
    compile
    viewer_if_possible
    (need "${animation_packages[@]}" "${browser_packages[@]}") || true # tests say what they lack
    run_tests "$@"
    ;;
check)
    take_nothing "$@"
    compile
    run_tests test_loading test_fused.TestReference test_save_load test_package
    ;;
bench)
    need "${bench_packages[@]}"
    compile
    run_yade "$root/scripts/bench.py" "$@"
    ;;
verify)
    need "${verify_packages[@]}"
    compile
    offer calculix-ccx "the comparison with CalculiX"
    run_yade "$root/scripts/verify.py" "$@"
    ;;
probe)
    need yade g++ binutils
    mkdir -p "$build"
    g++ -std=c++17 -O1 -shared -fPIC "$root/scripts/probing/allocations.cpp" -o "$build/allocations.so"
    export LD_PRELOAD=$build/allocations.so
    run_yade "$root/scripts/probe.py" "$@"
    ;;
sweep)
    need_for_sail "$@"
    need "${sweep_packages[@]}"
    compile
    viewer_if_possible
    set_environment
    exec python3 "$root/scripts/sweep.py" "$@"
    ;;
disk | stability | parts | chart)
    compile
    run_yade "$root/scripts/$command.py" "$@"
    ;;
docs)
    take_nothing "$@"
    need "${docs_packages[@]}" "${sail_packages[@]}" "${sweep_packages[@]}" "${calibrate_packages[@]}"
    compile
    run_yade "$root/reference/guide/make_site.py"
    ;;
viewer)
    take_nothing "$@"
    mkdir -p "$build"
    bundle_viewer
    ;;
report)
    compile
    bundle_viewer || exit
    run_yade "$root/scripts/report.py" "$@"
    ;;
animate)
    need "${animation_packages[@]}"
    compile
    run_yade "$root/scripts/animate.py" "$@"
    ;;
calibrate)
    need_for_sail "$@"
    need "${calibrate_packages[@]}"
    compile
    set_environment
    exec python3 "$root/scripts/calibrate.py" "$@"
    ;;
tidy)
    take_nothing "$@"
    tidy
    ;;
sanitize)
    take_nothing "$@"
    sanitize
    ;;
attack) attack "$@" ;;
packages)
    take_nothing "$@"
    need "${run_packages[@]}" "${build_packages[@]}"
    ;;
build)
    take_nothing "$@"
    compile
    ;;
package)
    take_nothing "$@"
    package
    ;;
format) format "$@" ;;
help | -h | --help) usage ;;
*)
    usage >&2
    die "unknown command '$command'"
    ;;
esac
