// Reads A and b of a file with MatLoad and VecLoad, and prints PETSc's CG iterations with Jacobi to ||b - A x|| <= 1e-2
// ||b|| from zero: petsc_solve FILE.
#include <petscksp.h>

int main(int argc, char** argv) {
  if (argc < 2 || PetscInitialize(nullptr, nullptr, nullptr, nullptr) != 0) return 1;
  const auto run = [&]() -> PetscErrorCode {
    PetscViewer file = nullptr;
    Mat a = nullptr;
    Vec b = nullptr, x = nullptr;
    KSP ksp = nullptr;
    PC pc = nullptr;
    PetscInt iterations = 0;
    PetscCall(PetscViewerBinaryOpen(PETSC_COMM_SELF, argv[1], FILE_MODE_READ, &file));
    PetscCall(MatCreate(PETSC_COMM_SELF, &a));
    PetscCall(MatLoad(a, file));
    PetscCall(VecCreate(PETSC_COMM_SELF, &b));
    PetscCall(VecLoad(b, file));
    PetscCall(VecDuplicate(b, &x));
    PetscCall(KSPCreate(PETSC_COMM_SELF, &ksp));
    PetscCall(KSPSetOperators(ksp, a, a));
    PetscCall(KSPSetType(ksp, KSPCG));
    PetscCall(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
    PetscCall(KSPGetPC(ksp, &pc));
    PetscCall(PCSetType(pc, PCJACOBI));
    PetscCall(KSPSetTolerances(ksp, 1e-2, 0, PETSC_DEFAULT, PETSC_DEFAULT));
    PetscCall(KSPSolve(ksp, b, x));
    PetscCall(KSPGetIterationNumber(ksp, &iterations));
    PetscCall(PetscPrintf(PETSC_COMM_SELF, "%d\n", static_cast<int>(iterations)));
    PetscCall(KSPDestroy(&ksp));
    PetscCall(VecDestroy(&x));
    PetscCall(VecDestroy(&b));
    PetscCall(MatDestroy(&a));
    return PetscViewerDestroy(&file);
  };
  return run() == 0 && PetscFinalize() == 0 ? 0 : 1;
}
