# Shared by tests/run, examples/run and the checks beside them; to be sourced. Defines say, spar_packages, spar_build.
# shellcheck shell=sh

say() {
    printf '== %s\n' "$*"
}

# spar_missing <package>...: those of the Debian packages that are not installed
spar_missing() {
    for package; do
        case "$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null)" in
        *"ok installed") ;;
        *) printf ' %s' "$package" ;;
        esac
    done
}

# spar_packages <package>...: installs those of the Debian packages that are missing; needs root (or sudo without a password)
# only then. Names the command where it cannot.
spar_packages() {
    if ! command -v dpkg-query >/dev/null 2>&1; then
        say "no dpkg here: taking for granted that there are $*"
        return 0
    fi
    missing=$(spar_missing "$@")
    if [ -z "$missing" ]; then
        say "packages: all there"
        return 0
    fi
    if [ "$(id -u)" = 0 ]; then
        as_root=
    elif command -v sudo >/dev/null 2>&1 && sudo -n true 2>/dev/null; then
        as_root=sudo
    else
        say "missing packages:$missing"
        say "run this as root, then again: apt-get update && apt-get install -y --no-install-recommends$missing"
        return 1
    fi
    say "installing packages:$missing"
    # shellcheck disable=SC2086
    { { [ -n "${spar_lists_new:-}" ] || $as_root apt-get -o Acquire::Retries=3 update -qq; } && spar_lists_new=1 &&
        DEBIAN_FRONTEND=noninteractive $as_root apt-get -o Acquire::Retries=3 -o Dpkg::Use-Pty=0 install -y -qq --no-install-recommends $missing; } >/dev/null
}

# What the build cannot do without, and what it takes where it is found; the tests and the plots come on top.
spar_needed_packages="gcc cmake libc6-dev libgsl-dev"
spar_taken_packages="ninja-build gfortran libopenblas-serial-dev libopenmpi-dev openmpi-bin"
spar_build_packages="$spar_needed_packages $spar_taken_packages g++ pkg-config"

# spar_example_packages: stops for what is needed alone
spar_example_packages() {
    if ! command -v ninja >/dev/null 2>&1 && ! command -v make >/dev/null 2>&1; then
        spar_needed_packages="$spar_needed_packages ninja-build"
    fi
    # shellcheck disable=SC2086
    spar_packages $spar_needed_packages || return 1
    # shellcheck disable=SC2086
    spar_packages $spar_taken_packages || say "going on without them: no ranks without Open MPI, no Fortran without gfortran; GSL's own CBLAS is slower"
    spar_packages gnuplot-nox || say "without gnuplot there are no plots; all else runs"
}

# Ranks as root, on fewer cores than ranks, without ssh (Open MPI).
spar_mpi_environment() {
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
    export OMPI_MCA_hwloc_base_binding_policy=none OMPI_MCA_plm_rsh_agent=true OMPI_MCA_btl_vader_single_copy_mechanism=none
}

# spar_jobs: as many compilers at a time as there are processors
spar_jobs() {
    nproc 2>/dev/null || echo 2
}

# spar_configure <source> <build> [cmake options]
spar_configure() {
    source_dir=$1
    build_dir=$2
    shift 2
    say "configuring $build_dir"
    if [ ! -f "$build_dir/CMakeCache.txt" ] && command -v ninja >/dev/null 2>&1; then
        set -- -G Ninja "$@"
    fi
    cmake -S "$source_dir" -B "$build_dir" "$@"
}

# spar_compile <build>: all, or $spar_targets
spar_compile() {
    say "building $1"
    # shellcheck disable=SC2086
    cmake --build "$1" -j "$(spar_jobs)" ${spar_targets:+--target $spar_targets}
}

# spar_build <source> <build> [cmake options]: both
spar_build() {
    spar_configure "$@" || return 1
    spar_compile "$2"
}
