#include "tests/bench/multigrid.hpp"

#include <petscksp.h>

#include "solver/cg/petsc_kernels.hpp"

namespace rodsweep::bench {

struct Multigrid::Impl {
  const Rod& rod;
  const LinearSystem& system;
  Kind kind;
  Mat a = nullptr;
  PC pc = nullptr;
  Vec r = nullptr, z = nullptr;

  void create();
  void destroy();
  void give_near_null_space();
};

void Multigrid::Impl::create() {
  const BlockMatrix& blocks = system.matrix();
  const PetscInt n = blocks.unknowns();
  petsc_check(MatCreateSeqBAIJ(PETSC_COMM_SELF, 6, n, n, 40, nullptr, &a), "MatCreateSeqBAIJ");
  petsc_check(MatSetOption(a, MAT_ROW_ORIENTED, PETSC_FALSE), "MatSetOption");
  petsc_check(MatSetOption(a, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE), "MatSetOption");
  for (PetscInt row = 0; row < blocks.block_rows(); ++row)
    for (int k = blocks.row_begin(row); k < blocks.row_end(row); ++k) {
      PetscScalar entries[36];
      for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 6; ++i) entries[6 * j + i] = blocks.blocks[static_cast<std::size_t>(k)].column[j][i];
      const PetscInt column = blocks.column(k);
      petsc_check(MatSetValuesBlocked(a, 1, &row, 1, &column, entries, INSERT_VALUES), "MatSetValuesBlocked");
    }
  petsc_check(MatAssemblyBegin(a, MAT_FINAL_ASSEMBLY), "MatAssemblyBegin");
  petsc_check(MatAssemblyEnd(a, MAT_FINAL_ASSEMBLY), "MatAssemblyEnd");
  petsc_check(MatConvert(a, MATSEQAIJ, MAT_INPLACE_MATRIX, &a), "MatConvert");
  petsc_check(MatSetBlockSize(a, 6), "MatSetBlockSize");
  petsc_check(MatSetOption(a, MAT_SPD, PETSC_TRUE), "MatSetOption");
  petsc_check(MatCreateVecs(a, &z, &r), "MatCreateVecs");
  if (kind == Kind::gamg) give_near_null_space();
  petsc_check(PCCreate(PETSC_COMM_SELF, &pc), "PCCreate");
  petsc_check(PCSetType(pc, kind == Kind::gamg ? PCGAMG : PCHYPRE), "PCSetType");
  if (kind == Kind::boomer) petsc_check(PCHYPRESetType(pc, "boomeramg"), "PCHYPRESetType");
  petsc_check(PCSetOperators(pc, a, a), "PCSetOperators");
}

void Multigrid::Impl::give_near_null_space() {
  Vec modes[6];
  for (int mode = 0; mode < 6; ++mode) {
    petsc_check(VecDuplicate(r, &modes[mode]), "VecDuplicate");
    PetscScalar* at = nullptr;
    petsc_check(VecGetArray(modes[mode], &at), "VecGetArray");
    for (std::size_t k = 0; k < rod.joints.size(); ++k) {
      const Joint& joint = rod.joints[k];
      const Vector3 local = rod.orientation[static_cast<std::size_t>(joint.b)].conjugate() * Vector3::Unit(mode % 3);
      for (int i = 0; i < 3; ++i) at[6 * k + 3 * (mode / 3) + i] = (mode < 3 ? joint.length : 1) * local[i];
    }
    petsc_check(VecRestoreArray(modes[mode], &at), "VecRestoreArray");
    for (int before = 0; before < mode; ++before) {
      PetscScalar along = 0;
      petsc_check(VecDot(modes[mode], modes[before], &along), "VecDot");
      petsc_check(VecAXPY(modes[mode], -along, modes[before]), "VecAXPY");
    }
    petsc_check(VecNormalize(modes[mode], nullptr), "VecNormalize");
  }
  MatNullSpace space = nullptr;
  petsc_check(MatNullSpaceCreate(PETSC_COMM_SELF, PETSC_FALSE, 6, modes, &space), "MatNullSpaceCreate");
  petsc_check(MatSetNearNullSpace(a, space), "MatSetNearNullSpace");
  petsc_check(MatNullSpaceDestroy(&space), "MatNullSpaceDestroy");
  for (Vec& mode : modes) petsc_check(VecDestroy(&mode), "VecDestroy");
}

void Multigrid::Impl::destroy() {
  PCDestroy(&pc);
  VecDestroy(&r);
  VecDestroy(&z);
  MatDestroy(&a);
}

Multigrid::Multigrid(Kind kind, const Rod& rod, const LinearSystem& system)
    : impl_(std::make_unique<Impl>(Impl{rod, system, kind})) {}
Multigrid::~Multigrid() { impl_->destroy(); }

void Multigrid::set_up() {
  impl_->destroy();
  impl_->create();
  petsc_check(PCSetUp(impl_->pc), "PCSetUp");
}

void Multigrid::apply(const VectorX& r, VectorX& z) {
  Impl& s = *impl_;
  petsc_check(VecPlaceArray(s.r, r.data()), "VecPlaceArray");
  petsc_check(VecPlaceArray(s.z, z.data()), "VecPlaceArray");
  petsc_check(PCApply(s.pc, s.r, s.z), "PCApply");
  petsc_check(VecResetArray(s.r), "VecResetArray");
  petsc_check(VecResetArray(s.z), "VecResetArray");
}

}  // namespace rodsweep::bench
