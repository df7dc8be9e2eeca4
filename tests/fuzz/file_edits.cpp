#include "tests/fuzz/file_edits.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "runner/file/hdf5.hpp"
#include "runner/job/job.hpp"
#include "tests/fuzz/byte_source.hpp"
#include "tests/runner/job_mutations.hpp"

namespace rodsweep::fuzz {
namespace {

namespace fs = std::filesystem;

void collect(const hdf5::File& file, const std::string& path, std::vector<std::string>& objects) {
  objects.push_back(path);
  const hdf5::Object object(hdf5::check(H5Oopen(file.id(), path.c_str(), H5P_DEFAULT), "H5Oopen", path));
  if (H5Iget_type(object.id()) != H5I_GROUP) return;
  for (const std::string& name : hdf5::members(object.id()))
    collect(file, (path == "/" ? "" : path) + "/" + name, objects);
}

hsize_t bytes_of(hid_t dataset) {
  const hdf5::Datatype type(H5Dget_type(dataset));
  const hdf5::Dataspace space(H5Dget_space(dataset));
  return static_cast<hsize_t>(H5Sget_simple_extent_npoints(space.id())) * H5Tget_size(type.id());
}

void change_values(hid_t dataset, ByteSource& input) {
  std::vector<char> values(bytes_of(dataset));
  if (values.empty()) return;
  const hdf5::Datatype type(H5Dget_type(dataset));
  if (H5Tis_variable_str(type.id()) > 0) return;  // pointers, that only HDF5 may change
  H5Dread(dataset, type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  const auto at = input.in_range<std::size_t>(0, values.size() - 1);
  for (std::size_t i = at, end = std::min(values.size(), at + input.in_range<std::size_t>(1, 12)); i < end; ++i)
    values[i] = input.value<char>();
  H5Dwrite(dataset, type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

/// Of a kind that readers may meet.
hdf5::Datatype some_type(ByteSource& input) {
  switch (input.in_range(0, 6)) {
    case 0: return hdf5::Datatype(H5Tcopy(H5T_NATIVE_UINT8));
    case 1: return hdf5::Datatype(H5Tcopy(H5T_NATIVE_INT64));
    case 2: return hdf5::Datatype(H5Tcopy(H5T_NATIVE_FLOAT));
    case 3: return hdf5::Datatype(H5Tcopy(H5T_NATIVE_DOUBLE));
    case 4: return hdf5::text_type(input.in_range<std::size_t>(1, 40));
    case 5: {
      hdf5::Datatype text(H5Tcopy(H5T_C_S1));
      H5Tset_size(text.id(), H5T_VARIABLE);
      return text;
    }
    default: {
      hdf5::Datatype pair(H5Tcreate(H5T_COMPOUND, 8));
      H5Tinsert(pair.id(), "a", 0, H5T_NATIVE_FLOAT);
      H5Tinsert(pair.id(), "b", 4, H5T_NATIVE_FLOAT);
      return pair;
    }
  }
}

/// Another dataset, of zeros or of nothing, in the place of one.
void replace(hid_t file, const std::string& path, ByteSource& input) {
  hdf5::Datatype type;
  std::vector<hsize_t> extent;
  {
    const hdf5::Dataset old(H5Dopen2(file, path.c_str(), H5P_DEFAULT));
    if (!old) return;
    type = input.flag() ? some_type(input) : hdf5::Datatype(H5Dget_type(old.id()));
    extent = hdf5::extent(old, path);
  }
  if (input.flag()) {
    extent.resize(input.in_range<std::size_t>(0, 4), 1);
    for (hsize_t& size : extent)
      if (input.flag()) size = input.in_range<hsize_t>(0, 9);
  }
  H5Ldelete(file, path.c_str(), H5P_DEFAULT);
  const hdf5::Dataspace space(extent.empty()
                                  ? H5Screate(H5S_SCALAR)
                                  : H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr));
  hdf5::Dataset(H5Dcreate2(file, path.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
}

void change_attribute(hid_t file, const std::string& path, ByteSource& input) {
  const hdf5::Object object(H5Oopen(file, path.c_str(), H5P_DEFAULT));
  if (!object) return;
  const std::vector<std::string> names = hdf5::attribute_names(object.id());
  if (names.empty()) return;
  const std::string& name = names[input.in_range<std::size_t>(0, names.size() - 1)];
  H5Adelete(object.id(), name.c_str());
  switch (input.in_range(0, 3)) {
    case 0: hdf5::write_attribute(object.id(), name.c_str(), input.value<std::int32_t>()); break;
    case 1: hdf5::write_attribute(object.id(), name.c_str(), input.text(20)); break;
    case 2: {
      const hdf5::Datatype type = some_type(input);
      const hsize_t size = input.in_range<hsize_t>(1, 3);
      const hdf5::Dataspace space(H5Screate_simple(1, &size, nullptr));
      hdf5::Attribute(H5Acreate2(object.id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT));
      break;
    }
    default: break;  // it is missing
  }
}

void edit(hid_t file, const std::vector<std::string>& objects, ByteSource& input) {
  const auto any = [&]() -> const std::string& {
    return objects[input.in_range<std::size_t>(1, objects.size() - 1)];  // but the root
  };
  const std::string& path = any();
  if (!hdf5::exists(file, path)) return;
  switch (input.in_range(0, 6)) {
    case 0: H5Ldelete(file, path.c_str(), H5P_DEFAULT); break;
    case 1: replace(file, path, input); break;
    case 2: change_attribute(file, input.flag() ? path : "/", input); break;
    case 3: {
      const std::string& other = any();
      if (!hdf5::exists(file, other)) break;
      H5Lmove(file, path.c_str(), file, "/moved", H5P_DEFAULT, H5P_DEFAULT);
      H5Lmove(file, other.c_str(), file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      H5Lmove(file, "/moved", file, other.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      break;
    }
    default:
      if (const hdf5::Dataset dataset(H5Dopen2(file, path.c_str(), H5P_DEFAULT)); dataset)
        change_values(dataset.id(), input);
  }
}

[[noreturn]] void report(const char* what, const std::string& text) {
  fmt::print(stderr, "{}: {}\n", what, text);
  std::abort();
}

}  // namespace

Original::Original(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  contents_.assign(std::istreambuf_iterator<char>(in), {});
  collect(hdf5::open_file(path, H5F_ACC_RDONLY), "/", objects_);
}

void Original::edited(const fs::path& path, const std::uint8_t* bytes, std::size_t size) const {
  constexpr int most_edits = 4;
  std::ofstream(path, std::ios::binary).write(contents_.data(), static_cast<std::streamsize>(contents_.size()));
  ByteSource input(bytes, size);
  const hdf5::File file = hdf5::open_file(path, H5F_ACC_RDWR);
  try {
    for (int i = 0; i < most_edits && input.left() > 0; ++i) edit(file.id(), objects_, input);
  } catch (const Hdf5Error&) {  // of an edit to what an earlier one took away
  }
}

void expect_plain(const fs::path& file, std::string_view input, const std::function<void()>& work) {
  std::string refusal;
  try {
    work();
    return;
  } catch (const FileError& error) {
    refusal = error.what();
  } catch (const JobError& error) {
    refusal = error.what();
  } catch (const std::exception& error) {
    report("neither a FileError nor a JobError", error.what());
  }
  if (refusal.find(file.native()) == std::string::npos) report("a refusal does not name the file", refusal);
  if (const std::string word = inside_word(refusal, input); !word.empty())
    report("a refusal is not for users", refusal);
}

fs::path scratch_folder() {
  const fs::path memory = "/dev/shm";
  fs::path folder =
      (fs::exists(memory) ? memory : fs::temp_directory_path()) / fmt::format("rodsweep-fuzz-{}", getpid());
  fs::create_directories(folder);
  static const fs::path made = folder;
  std::atexit([] {
    std::error_code ignored;
    fs::remove_all(made, ignored);
  });
  return folder;
}

}  // namespace rodsweep::fuzz
