# Spack's recipe, to be copied to var/spack/repos/builtin/packages/spar/package.py; see ../README.md for what is to be filled in
# and what was tried.
from spack.package import *


class Spar(CMakePackage):
    """Couples structures (geometrically exact beams, rigid bodies, joints) with fluid solvers: motion out, loads in,
    force, moment and power conserved by the map, a time coupling that stays stable when the fluid is heavy."""

    homepage = "https://example.org/spar"
    url = "https://example.org/spar/spar-0.9.0.tar.gz"

    license("BSD-3-Clause AND GPL-3.0-or-later", checked_by="spar", when="+gsl")  # its own sources, and GSL that it links
    license("BSD-3-Clause", checked_by="spar", when="~gsl")

    version("0.9.0", sha256="0000000000000000000000000000000000000000000000000000000000000000")

    variant("mpi", default=True, description="Sessions over an MPI communicator")
    variant("fortran", default=True, description="The Fortran modules")
    variant("gsl", default=True, description="GSL; without it LAPACK does what GSL does")
    variant("openblas", default=True, description="OpenBLAS in place of GSL's own CBLAS")

    depends_on("c", type="build")
    depends_on("fortran", type="build", when="+fortran")
    depends_on("cmake@3.22:", type="build")
    depends_on("gsl", when="+gsl")
    depends_on("gsl", type="test")
    depends_on("openblas threads=none", when="+openblas")
    depends_on("lapack", when="~gsl~openblas")
    depends_on("mpi", when="+mpi")
    depends_on("cmocka", type="test")

    conflicts("%gcc@:9")
    conflicts("%clang@:13")

    def cmake_args(self):
        return [
            self.define_from_variant("SPAR_MPI", "mpi"),
            self.define_from_variant("SPAR_FORTRAN", "fortran"),
            self.define_from_variant("SPAR_GSL", "gsl"),
            self.define_from_variant("SPAR_OPENBLAS", "openblas"),
            self.define("SPAR_BUILD_TESTS", self.run_tests),
            self.define("SPAR_BUILD_EXAMPLES", False),
            self.define("SPAR_BUILD_BENCHMARKS", False),
        ]

    def check(self):
        with working_dir(self.build_directory):
            ctest("-L", "unit", "--output-on-failure")
