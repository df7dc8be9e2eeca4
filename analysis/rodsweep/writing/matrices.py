"""Writes a linear system for other programs: Matrix Market, PETSc's binary format, or NumPy's archive."""

import numpy as np
import scipy.io

from rodsweep.writing import outputs

PETSC_MATRIX, PETSC_VECTOR = 1211216, 1211214    # class ids of PETSc's files


def matrix_market(system, stem):
    """STEM.mtx and, as arrays, STEM_b.mtx and STEM_x.mtx. Entries have 17 digits, so doubles come back exactly."""
    comment = f"rod {system.rod}, step {system.step}, Newton iteration {system.newton}, dt {system.dt_s:.17g} s"
    paths = [f"{stem}{ending}.mtx" for ending in ("", "_b", "_x")]
    for path, matrix in zip(paths, (system.A.tocoo(), system.b[:, None], system.x[:, None])):
        with outputs.whole(path) as part, open(part, "wb") as file:    # SciPy itself ignores a full disk
            scipy.io.mmwrite(file, matrix, comment=comment, precision=17,
                             symmetry="symmetric" if path == paths[0] else "general")
    return paths


def petsc(system, stem):
    """STEM.petsc: A, b and x, for MatLoad and VecLoad (32-bit integers, real numbers, big-endian)."""
    a = system.A.tocsr()
    a.sort_indices()
    with outputs.whole(f"{stem}.petsc") as part, open(part, "wb") as file:
        np.array([PETSC_MATRIX, *a.shape, a.nnz], ">i4").tofile(file)
        np.diff(a.indptr).astype(">i4").tofile(file)
        a.indices.astype(">i4").tofile(file)
        a.data.astype(">f8").tofile(file)
        for vector in (system.b, system.x):
            np.array([PETSC_VECTOR, len(vector)], ">i4").tofile(file)
            vector.astype(">f8").tofile(file)
    return [f"{stem}.petsc"]


def npz(system, stem):
    """STEM.npz: A as data, indices, indptr of scipy.sparse.bsr_matrix, and all other arrays of the system."""
    arrays = {name: getattr(system, name) for name in ("b", "x", "multipliers", "position_m", "orientation")}
    place = {name: getattr(system, name) for name in ("rod", "step", "newton", "dt_s")}
    with outputs.whole(f"{stem}.npz") as part:
        np.savez(part, data=system.A.data, indices=system.A.indices, indptr=system.A.indptr, **arrays, **place,
                 **vars(system.of))
    return [f"{stem}.npz"]


FORMATS = {"matrix-market": (".mtx", matrix_market), "petsc": (".petsc", petsc), "npz": (".npz", npz)}    # first file, writer
