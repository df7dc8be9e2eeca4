// Data sets, as a training and the guess knn read them.
#include "runner/dataset/dataset_reader.hpp"
#include "solver/linear/petsc_session.hpp"
#include "tests/fuzz/file_edits.hpp"
#include "tests/runner/data_set_examples.hpp"

using namespace rodsweep;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const PetscSession& petsc = *new PetscSession;  // until the process ends, whose end libFuzzer brings about
  static_cast<void>(petsc);
  static const std::filesystem::path folder = fuzz::scratch_folder(), path = folder / "edited.h5";
  static const fuzz::Original original = [] {
    make_data_set(folder / "original.h5", data_job());
    return fuzz::Original(folder / "original.h5");
  }();
  original.edited(path, data, size);
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  fuzz::expect_plain(path, input, [] {
    const DatasetReader reader(path);
    reader.read(0, reader.size());
  });
  return 0;
}
