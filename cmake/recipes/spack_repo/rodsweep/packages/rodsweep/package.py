# rodsweep for Spack 1.0 and later, from a clone (docs/installing.md):
#   spack repo add cmake/recipes/spack_repo/rodsweep
#   spack dev-build --source-path . rodsweep@main
from spack_repo.builtin.build_systems.cmake import CMakePackage

from spack.package import *


class Rodsweep(CMakePackage):
    """A distributed runner of experiments on initial guesses for the conjugate-gradient solve inside position-based
    Cosserat rod simulations: MPI, PETSc, parallel HDF5."""

    license("MIT")

    version("main")

    variant("analysis", default=True, description="Python packages for the analysis scripts that are installed with it")
    variant("bench", default=False, description="Build the benchmarks")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("git", type="build")  # asked for the revision that `rodsweep info` tells

    depends_on("mpi")
    depends_on("hdf5@1.10:+mpi")
    depends_on("petsc@3.18:+mpi+double~complex~int64")
    depends_on("metis@5.1:~int64")
    depends_on("eigen@3.4:")
    depends_on("boost@1.74:")  # headers
    depends_on("nanoflann@1.4:")
    depends_on("nlohmann-json@3.11:")
    depends_on("cli11@2.1:")
    depends_on("fmt@9:")
    depends_on("catch2@2.13:", type="test")
    depends_on("benchmark@1.7:", when="+bench")

    with when("+analysis"):
        depends_on("python@3.11:", type=("build", "link", "run"))
        depends_on("py-pybind11", type="build")  # guesses in Python
        depends_on("py-numpy", type="run")
        depends_on("py-scipy", type="run")
        depends_on("py-h5py", type="run")
        depends_on("py-matplotlib", type="run")
        depends_on("py-pillow", type="run")
        depends_on("py-pandas", type="run")
        depends_on("py-xarray", type="run")
        depends_on("py-jinja2", type="run")

    def cmake_args(self):
        return [
            self.define("RODSWEEP_NATIVE", False),  # Spack's compilers are told the target
            self.define("RODSWEEP_TESTS", self.run_tests),
            self.define_from_variant("RODSWEEP_BENCH", "bench"),
        ]

    def check(self):
        with working_dir(self.build_directory):
            ctest("-L", "unit", "--output-on-failure")
