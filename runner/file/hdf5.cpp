#include "runner/file/hdf5.hpp"

#include <algorithm>
#include <new>
#include <numeric>

namespace rodsweep {
namespace {

bool broken = false;

}  // namespace

bool hdf5_is_broken() { return broken; }
void set_hdf5_broken() { broken = true; }

}  // namespace rodsweep

namespace rodsweep::hdf5 {
namespace {

constexpr std::size_t most_axes = 8;

/// Stops HDF5 from printing its error stack; exceptions contain it.
void silence() {
  static const herr_t done = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  static_cast<void>(done);
}

/// Exceptions must not pass through HDF5: if memory runs out, the text ends here.
herr_t append_description(unsigned, const H5E_error2_t* error, void* text) noexcept try {
  auto& all = *static_cast<std::string*>(text);
  if (error->desc != nullptr && *error->desc != '\0' && all.find(error->desc) == std::string::npos) {
    all += (all.empty() ? "" : "; ") + std::string(error->desc);
  }
  return 0;
} catch (const std::bad_alloc&) {
  return -1;
}

Attribute create_attribute(hid_t object, const char* name, const Datatype& type) {
  const Dataspace scalar(check(H5Screate(H5S_SCALAR), "H5Screate"));
  return Attribute(
      check(H5Acreate2(object, name, type.id(), scalar.id(), H5P_DEFAULT, H5P_DEFAULT), "H5Acreate2", name));
}

struct OpenAttribute {
  OpenAttribute(hid_t file, const std::string& path, const char* name)
      : object(check(H5Oopen(file, path.c_str(), H5P_DEFAULT), "H5Oopen", path)),
        attribute(check(H5Aopen(object.id(), name, H5P_DEFAULT), "H5Aopen", name)) {
    // An array would be read past the end of the buffer.
    const Dataspace space(check(H5Aget_space(attribute.id()), "H5Aget_space", name));
    if (H5Sget_simple_extent_npoints(space.id()) != 1)
      throw Hdf5Error("attribute " + std::string(name) + " of " + path + " is not a single value");
  }
  Object object;
  Attribute attribute;
};

/// Length of a fixed-length text type; throws Hdf5Error for any other type.
std::size_t text_bytes(hid_t type, const std::string& path) {
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0)
    throw Hdf5Error(path + " does not hold text of a fixed length");
  return H5Tget_size(type);
}

/// The system's error message in HDF5's error stack, if a system call failed; else empty.
std::string system_reason(const std::string& text) {
  const std::string mark = "error message = '";
  const std::size_t begin = text.find(mark);
  if (begin == std::string::npos) return "";
  const std::size_t end = text.find('\'', begin + mark.size());
  return text.substr(begin + mark.size(), end == std::string::npos ? end : end - begin - mark.size());
}

PropertyList creation_of(const Dataset& dataset, const std::string& path) {
  return PropertyList(check(H5Dget_create_plist(dataset.id()), "H5Dget_create_plist", path));
}

std::string without_padding(const char* text, std::size_t bytes) { return {text, std::find(text, text + bytes, '\0')}; }

}  // namespace

void fail(const char* call, std::string_view object) {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, append_description, &text);
  const std::string_view name = call;
  if (name == "H5Fclose" || name == "H5Dwrite" || name == "H5Awrite" || name == "H5Dcreate2") set_hdf5_broken();
  if (const std::string reason = system_reason(text); !reason.empty()) text = reason;
  std::string what = std::string(call) + " failed";
  if (!object.empty()) what += " on " + std::string(object);
  throw Hdf5Error(what + ": " + (text.empty() ? "no error text" : text));
}

Datatype text_type(std::size_t bytes) {
  Datatype type(check(H5Tcopy(H5T_C_S1), "H5Tcopy"));
  check(H5Tset_size(type.id(), std::max<std::size_t>(bytes, 1)), "H5Tset_size");
  check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "H5Tset_strpad");
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "H5Tset_cset");
  return type;
}

std::string fixed_text(std::string_view text, std::size_t bytes) {
  std::size_t end = std::min(text.size(), bytes);
  if (end < text.size()) {
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // inside a UTF-8 character
  }
  std::string fixed(text.substr(0, end));
  fixed.resize(bytes, '\0');
  return fixed;
}

PropertyList unlocked_access() {
  silence();
  PropertyList access(check(H5Pcreate(H5P_FILE_ACCESS), "H5Pcreate"));
  check(H5Pset_file_locking(access.id(), false, true), "H5Pset_file_locking");
  return access;
}

File create_file(const std::filesystem::path& path) {
  const PropertyList access = unlocked_access();
  return File(check(H5Fcreate(path.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, access.id()), "H5Fcreate", path.native()));
}

File open_file(const std::filesystem::path& path, unsigned flags, hid_t access) {
  silence();
  const PropertyList unlocked = unlocked_access();
  const hid_t used = access == H5P_DEFAULT ? unlocked.id() : access;
  return File(check(H5Fopen(path.c_str(), flags, used), "H5Fopen", path.native()));
}

Dataset create_dataset(hid_t file, const std::string& path, hid_t type, const std::vector<hsize_t>& extent) {
  const PropertyList links(check(H5Pcreate(H5P_LINK_CREATE), "H5Pcreate"));
  check(H5Pset_create_intermediate_group(links.id(), 1), "H5Pset_create_intermediate_group");
  const PropertyList creation(check(H5Pcreate(H5P_DATASET_CREATE), "H5Pcreate"));
  check(H5Pset_layout(creation.id(), H5D_CONTIGUOUS), "H5Pset_layout");
  check(H5Pset_alloc_time(creation.id(), H5D_ALLOC_TIME_EARLY), "H5Pset_alloc_time");
  check(H5Pset_fill_time(creation.id(), H5D_FILL_TIME_NEVER), "H5Pset_fill_time");
  check(H5Pset_obj_track_times(creation.id(), false), "H5Pset_obj_track_times");
  const Dataspace space(
      extent.empty()
          ? check(H5Screate(H5S_SCALAR), "H5Screate")
          : check(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), "H5Screate_simple", path));
  return Dataset(check(H5Dcreate2(file, path.c_str(), type, space.id(), links.id(), creation.id(), H5P_DEFAULT),
                       "H5Dcreate2", path));
}

Dataset open_dataset(hid_t file, const std::string& path) {
  return Dataset(check(H5Dopen2(file, path.c_str(), H5P_DEFAULT), "H5Dopen2", path));
}

bool exists(hid_t file, const std::string& path) {
  for (std::size_t slash = path.find('/', 1);; slash = path.find('/', slash + 1)) {
    if (check(H5Lexists(file, path.substr(0, slash).c_str(), H5P_DEFAULT), "H5Lexists", path) == 0) return false;
    if (slash == std::string::npos) return true;
  }
}

std::vector<hsize_t> extent(const Dataset& dataset, const std::string& path) {
  const Dataspace space(check(H5Dget_space(dataset.id()), "H5Dget_space", path));
  std::vector<hsize_t> sizes(
      static_cast<std::size_t>(check(H5Sget_simple_extent_ndims(space.id()), "H5Sget_simple_extent_ndims", path)));
  check(H5Sget_simple_extent_dims(space.id(), sizes.data(), nullptr), "H5Sget_simple_extent_dims", path);
  return sizes;
}

hsize_t value_count(const Dataset& dataset, const std::string& path) {
  const Datatype type(check(H5Dget_type(dataset.id()), "H5Dget_type", path));
  const auto value_bytes = static_cast<double>(H5Tget_size(type.id()));
  hsize_t count = 1;
  double bytes = value_bytes;
  for (const hsize_t n : extent(dataset, path)) count *= n, bytes *= static_cast<double>(n);
  auto stored = static_cast<double>(H5Dget_storage_size(dataset.id()));
  const PropertyList creation = creation_of(dataset, path);
  if (H5Pget_layout(creation.id()) == H5D_CHUNKED) {  // a filter may store a chunk in any number of bytes
    hsize_t chunk[most_axes] = {}, chunks = 0;
    const int axes = check(H5Pget_chunk(creation.id(), static_cast<int>(most_axes), chunk), "H5Pget_chunk", path);
    const Dataspace all(check(H5Dget_space(dataset.id()), "H5Dget_space", path));
    check(H5Dget_num_chunks(dataset.id(), all.id(), &chunks), "H5Dget_num_chunks", path);
    stored = static_cast<double>(chunks) * value_bytes;
    for (int axis = 0; axis < axes; ++axis) stored *= static_cast<double>(chunk[axis]);
  }
  if (bytes > stored) throw Damage(path + " has a shape that is larger than its data");
  return count;
}

bool is_contiguous(hid_t file, const std::string& path) {
  return H5Pget_layout(creation_of(open_dataset(file, path), path).id()) == H5D_CONTIGUOUS;
}

RowDataset::RowDataset(hid_t file, std::string path) : path_(std::move(path)) {
  if (!exists(file, path_)) return;
  dataset_ = open_dataset(file, path_);
  extent_ = hdf5::extent(dataset_, path_);
  if (extent_.empty() || extent_.size() > most_axes) throw Hdf5Error(path_ + " does not consist of rows");
  space_ = Dataspace(check(H5Dget_space(dataset_.id()), "H5Dget_space", path_));
  value_count(dataset_, path_);
  row_values_ = std::accumulate(extent_.begin() + 1, extent_.end(), hsize_t{1}, std::multiplies<>());
}

Datatype RowDataset::type() const { return Datatype(check(H5Dget_type(dataset_.id()), "H5Dget_type", path_)); }

/// Selects the rows in the file and returns the memory space for their values.
Dataspace RowDataset::select(hsize_t first, hsize_t count) const {
  if (!dataset_) throw Hdf5Error((path_.empty() ? "a dataset" : path_) + " is not in the file");
  hsize_t start[most_axes] = {first}, size[most_axes] = {count};
  std::copy(extent_.begin() + 1, extent_.end(), size + 1);
  check(H5Sselect_hyperslab(space_.id(), H5S_SELECT_SET, start, nullptr, size, nullptr), "H5Sselect_hyperslab", path_);
  const hsize_t values = count * row_values_;
  return Dataspace(check(H5Screate_simple(1, &values, nullptr), "H5Screate_simple", path_));
}

void RowDataset::write(hid_t type, hsize_t first, hsize_t count, const void* values) const {
  const Dataspace memory = select(first, count);
  check(H5Dwrite(dataset_.id(), type, memory.id(), space_.id(), H5P_DEFAULT, values), "H5Dwrite", path_);
}

void RowDataset::read(hid_t type, hsize_t first, hsize_t count, void* values) const {
  const Dataspace memory = select(first, count);
  check(H5Dread(dataset_.id(), type, memory.id(), space_.id(), H5P_DEFAULT, values), "H5Dread", path_);
}

std::string RowDataset::text(hsize_t row) const {
  const Datatype stored = type();
  std::string buffer(text_bytes(stored.id(), path_) * row_values_, '\0');
  read(stored.id(), row, 1, buffer.data());
  return without_padding(buffer.data(), buffer.size());
}

void RowDataset::put_text(hsize_t row, std::string_view text) const {
  const Datatype stored = type();
  write(stored.id(), row, 1, fixed_text(text, text_bytes(stored.id(), path_)).data());
}

template <>
std::vector<std::string> read_all(hid_t file, const std::string& path) {
  const Dataset dataset = open_dataset(file, path);
  const Datatype type(check(H5Dget_type(dataset.id()), "H5Dget_type", path));
  const std::size_t bytes = text_bytes(type.id(), path);
  const hsize_t count = value_count(dataset, path);
  std::vector<char> buffer(count * bytes);
  check(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer.data()), "H5Dread", path);
  std::vector<std::string> texts(count);
  for (std::size_t i = 0; i < count; ++i) texts[i] = without_padding(buffer.data() + i * bytes, bytes);
  return texts;
}

void visit_texts(hid_t file, const std::string& path, std::size_t rows,
                 const std::function<void(std::size_t, const std::string&)>& visit) {
  constexpr std::size_t block = 1 << 14;
  const RowDataset dataset(file, path);
  if (dataset.rows() != rows || dataset.row_values() != 1) throw Damage(path + " has another shape than other columns");
  const Datatype type = dataset.type();
  const std::size_t bytes = text_bytes(type.id(), path);
  std::vector<char> buffer(std::min(block, rows) * bytes);
  for (std::size_t begin = 0; begin < rows; begin += block) {
    const std::size_t count = std::min(block, rows - begin);
    dataset.read(type.id(), begin, count, buffer.data());
    for (std::size_t i = 0; i < count; ++i) visit(begin + i, without_padding(buffer.data() + i * bytes, bytes));
  }
}

void write_all(hid_t file, const std::string& path, const std::vector<std::string>& values) {
  const Dataset dataset = open_dataset(file, path);
  const Datatype type(check(H5Dget_type(dataset.id()), "H5Dget_type", path));
  std::string buffer;
  for (const std::string& value : values) buffer += fixed_text(value, H5Tget_size(type.id()));
  check(H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer.data()), "H5Dwrite", path);
}

void store_texts(hid_t file, const std::string& path, const std::vector<std::string>& texts) {
  std::size_t bytes = 1;
  for (const std::string& text : texts) bytes = std::max(bytes, text.size());
  create_dataset(file, path, text_type(bytes).id(), {texts.size()});
  write_all(file, path, texts);
}

void write_attribute(hid_t object, const char* name, std::string_view value) {
  const Datatype type = text_type(value.size());
  const Attribute attribute = create_attribute(object, name, type);
  const std::string buffer = fixed_text(value, std::max<std::size_t>(value.size(), 1));
  check(H5Awrite(attribute.id(), type.id(), buffer.data()), "H5Awrite", name);
}

void write_attribute(hid_t object, const char* name, std::int32_t value) {
  const Attribute attribute =
      create_attribute(object, name, Datatype(check(H5Tcopy(type_of<std::int32_t>()), "H5Tcopy")));
  check(H5Awrite(attribute.id(), type_of<std::int32_t>(), &value), "H5Awrite", name);
}

bool has_attribute(hid_t file, const std::string& object, const char* name) {
  return check(H5Aexists_by_name(file, object.c_str(), name, H5P_DEFAULT), "H5Aexists_by_name", name) > 0;
}

std::string read_text_attribute(hid_t file, const std::string& object, const char* name) {
  const OpenAttribute open(file, object, name);
  const Datatype type(check(H5Aget_type(open.attribute.id()), "H5Aget_type", name));
  std::string buffer(text_bytes(type.id(), name), '\0');
  check(H5Aread(open.attribute.id(), type.id(), buffer.data()), "H5Aread", name);
  return without_padding(buffer.data(), buffer.size());
}

std::int32_t read_int_attribute(hid_t file, const std::string& object, const char* name) {
  const OpenAttribute open(file, object, name);
  std::int32_t value = 0;
  check(H5Aread(open.attribute.id(), type_of<std::int32_t>(), &value), "H5Aread", name);
  return value;
}

}  // namespace rodsweep::hdf5
