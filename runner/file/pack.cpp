#include "runner/file/pack.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "runner/file/file_reading.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/unfinished_file.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

constexpr hsize_t chunk_bytes = 1 << 18;  // small for readers of single tasks, but large enough to compress well
constexpr hsize_t least_bytes = 1 << 12;  // below, a chunk's index takes more than is saved
constexpr unsigned deflate_level = 4;     // higher levels take much longer and save little
constexpr const char* state_path = "/tasks/state";

void copy_attributes(hid_t from, hid_t to) {
  for (const std::string& name : hdf5::attribute_names(from)) {
    const hdf5::Attribute source(hdf5::check(H5Aopen(from, name.c_str(), H5P_DEFAULT), "H5Aopen", name));
    const hdf5::Datatype type(hdf5::check(H5Aget_type(source.id()), "H5Aget_type", name));
    const hdf5::Dataspace space(hdf5::check(H5Aget_space(source.id()), "H5Aget_space", name));
    std::vector<char> value(H5Aget_storage_size(source.id()));
    hdf5::check(H5Aread(source.id(), type.id(), value.data()), "H5Aread", name);
    const hdf5::Attribute target(
        hdf5::check(H5Acreate2(to, name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), "H5Acreate2", name));
    hdf5::check(H5Awrite(target.id(), type.id(), value.data()), "H5Awrite", name);
  }
}

/// Whole rows of about chunk_bytes in total; part of a row if a row is longer.
std::vector<hsize_t> chunk_of(const std::vector<hsize_t>& extent, hsize_t element_bytes) {
  std::vector<hsize_t> chunk = extent;
  hsize_t room = std::max<hsize_t>(1, chunk_bytes / element_bytes);
  for (std::size_t axis = extent.size(); axis-- > 0;) {
    chunk[axis] = std::min(extent[axis], room);
    room = std::max<hsize_t>(1, room / chunk[axis]);
  }
  return chunk;
}

hdf5::Dataset create_packed(hid_t file, const std::string& path, hid_t type, const std::vector<hsize_t>& extent) {
  const hsize_t element_bytes = H5Tget_size(type);
  const hsize_t bytes = std::accumulate(extent.begin(), extent.end(), element_bytes, std::multiplies<>());
  if (extent.empty() || bytes < least_bytes) return hdf5::create_dataset(file, path, type, extent);
  const hdf5::PropertyList creation(hdf5::check(H5Pcreate(H5P_DATASET_CREATE), "H5Pcreate"));
  const std::vector<hsize_t> chunk = chunk_of(extent, element_bytes);
  hdf5::check(H5Pset_chunk(creation.id(), static_cast<int>(chunk.size()), chunk.data()), "H5Pset_chunk", path);
  hdf5::check(H5Pset_shuffle(creation.id()), "H5Pset_shuffle");
  hdf5::check(H5Pset_deflate(creation.id(), deflate_level), "H5Pset_deflate");
  hdf5::check(H5Pset_fletcher32(creation.id()), "H5Pset_fletcher32");
  hdf5::check(H5Pset_obj_track_times(creation.id(), false), "H5Pset_obj_track_times");
  const hdf5::Dataspace space(
      hdf5::check(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), "H5Screate_simple", path));
  return hdf5::Dataset(hdf5::check(
      H5Dcreate2(file, path.c_str(), type, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), "H5Dcreate2", path));
}

void copy_dataset(const hdf5::File& source, const hdf5::File& target, const std::string& path, const Continue& go_on) {
  const hdf5::Dataset from = hdf5::open_dataset(source.id(), path);
  const hdf5::Datatype type(hdf5::check(H5Dget_type(from.id()), "H5Dget_type", path));
  const std::vector<hsize_t> extent = hdf5::extent(from, path);
  {
    const hdf5::Dataset to = create_packed(target.id(), path, type.id(), extent);
    copy_attributes(from.id(), to.id());
    if (extent.empty()) {
      std::vector<char> value(H5Tget_size(type.id()));
      hdf5::check(H5Dread(from.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()), "H5Dread", path);
      hdf5::check(H5Dwrite(to.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()), "H5Dwrite", path);
      return;
    }
  }
  const hdf5::RowDataset rows(source.id(), path), packed(target.id(), path);
  const hsize_t row_bytes = rows.row_values() * H5Tget_size(type.id());
  // A multiple of the chunk's rows, so that each chunk is compressed once.
  const hsize_t chunk_rows = chunk_of(extent, H5Tget_size(type.id())).front();
  const hsize_t block = chunk_rows * std::max<hsize_t>(1, 16 * chunk_bytes / (chunk_rows * row_bytes));
  std::vector<char> values(std::min(block, rows.rows()) * row_bytes);
  for (hsize_t first = 0; first < rows.rows(); first += block) {
    go_on();
    const hsize_t count = std::min(block, rows.rows() - first);
    rows.read(type.id(), first, count, values.data());
    packed.write(type.id(), first, count, values.data());
  }
}

void copy_group(const hdf5::File& source, const hdf5::File& target, const std::string& group, const Continue& go_on) {
  std::vector<std::string> names;
  const std::string prefix = group == "/" ? group : group + "/";
  {
    const hdf5::Object from(hdf5::check(H5Oopen(source.id(), group.c_str(), H5P_DEFAULT), "H5Oopen", group));
    const hdf5::Object to(
        hdf5::check(group == "/" ? H5Oopen(target.id(), "/", H5P_DEFAULT)
                                 : H5Gcreate2(target.id(), group.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                    "H5Gcreate2", group));
    copy_attributes(from.id(), to.id());
    names = hdf5::members(from.id());
  }
  for (const std::string& name : names) {
    const std::string path = prefix + name;
    H5I_type_t kind = H5I_BADID;
    {
      const hdf5::Object object(hdf5::check(H5Oopen(source.id(), path.c_str(), H5P_DEFAULT), "H5Oopen", path));
      kind = H5Iget_type(object.id());
    }
    if (kind == H5I_GROUP) copy_group(source, target, path, go_on);
    if (kind == H5I_DATASET) copy_dataset(source, target, path, go_on);
  }
}

void refuse_damaged(const fs::path& path, const Verification& verified, const char* what_now) {
  if (verified.damaged.empty()) return;
  throw FileError(fmt::format("{} is damaged: wrong checksum of task{} {}; {}", path.native(),
                              verified.damaged.size() == 1 ? "" : "s", fmt::join(verified.damaged, ", "), what_now));
}

}  // namespace

bool is_packed(const hdf5::File& file) {
  // All but small datasets are compressed. /runs/command has a fixed size and is always compressed.
  const hdf5::Dataset dataset = hdf5::open_dataset(file.id(), "/runs/command");
  const hdf5::PropertyList creation(
      hdf5::check(H5Dget_create_plist(dataset.id()), "H5Dget_create_plist", "/runs/command"));
  return hdf5::check(H5Pget_nfilters(creation.id()), "H5Pget_nfilters", "/runs/command") > 0;
}

Packing pack_results(const fs::path& source_path, const fs::path& target_path, const Continue& go_on) {
  refuse_existing(target_path);
  const hdf5::File source = open_results(source_path);
  stored_job_text(source, source_path);
  // States before data: all data of a task with state 1 are in the file.
  const std::vector<std::uint8_t> states = read_states(source, source_path);
  refuse_damaged(source_path, verify(source_path, go_on), "nothing was packed");

  make_folder_of(target_path);
  const UnfinishedFile unfinished(target_path);
  unfinished.check_creatable();
  Packing packing;
  try {
    hdf5::File target = hdf5::create_file(unfinished.path());
    copy_group(source, target, "/", go_on);
    hdf5::write_all(target.id(), state_path, states);
    hdf5::close(target, "H5Fclose", unfinished.path().native());
  } catch (const Hdf5Error& failure) {
    throw writing_error(target_path, failure.what());
  }
  const Verification verified = verify(unfinished.path(), go_on);
  refuse_damaged(unfinished.path(), verified, "the copy was deleted, and the original is unchanged");
  packing.tasks = static_cast<std::int64_t>(states.size());
  packing.verified = verified.checked;
  packing.bytes_before = fs::file_size(source_path);
  packing.bytes_after = fs::file_size(unfinished.path());
  unfinished.publish();
  return packing;
}

}  // namespace rodsweep
