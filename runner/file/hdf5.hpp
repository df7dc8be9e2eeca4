// Owners of HDF5 handles, one check for all calls, and the access functions that rodsweep needs (HDF5 1.10 C API).
//
// Datasets are contiguous with early allocation, without fill values and time stamps. So their place in the file is
// fixed at creation, unwritten bytes are zero, and files with the same data have the same metadata. Texts have a fixed
// length, padded with zeros. HDF5's locks are off, because readers may open the file while a sweep writes, and some
// network file systems refuse locks. Throws Hdf5Error with the failed call, the object and HDF5's error text.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "runner/file/file_error.hpp"

namespace rodsweep::hdf5 {

/// Owns one handle; empty after a move.
template <herr_t (*Close)(hid_t)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(hid_t id) noexcept : id_(id) {}
  Handle(Handle&& other) noexcept : id_(other.release()) {}
  Handle& operator=(Handle&& other) noexcept {
    Handle taken(std::move(other));
    std::swap(id_, taken.id_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) Close(id_);
  }

  hid_t id() const noexcept { return id_; }
  explicit operator bool() const noexcept { return id_ >= 0; }
  /// Returns the handle without closing it.
  hid_t release() noexcept { return std::exchange(id_, H5I_INVALID_HID); }

 private:
  hid_t id_ = H5I_INVALID_HID;
};

using File = Handle<H5Fclose>;
using Object = Handle<H5Oclose>;
using Dataset = Handle<H5Dclose>;
using Dataspace = Handle<H5Sclose>;
using Datatype = Handle<H5Tclose>;
using Attribute = Handle<H5Aclose>;
using PropertyList = Handle<H5Pclose>;

static_assert(std::is_nothrow_move_constructible_v<File> && std::is_nothrow_move_assignable_v<File>);
static_assert(!std::is_copy_constructible_v<File> && !std::is_copy_assignable_v<File>);

/// Throws Hdf5Error for `call` on `object`, with the text of HDF5's error stack.
[[noreturn]] void fail(const char* call, std::string_view object);

/// Returns the result of an HDF5 call; calls fail() if it is negative.
template <class Result>
Result check(Result result, const char* call, std::string_view object = {}) {
  if (result < 0) fail(call, object);
  return result;
}

/// Closes the handle and reports failure, unlike the destructor.
template <herr_t (*Close)(hid_t)>
void close(Handle<Close>& handle, const char* call, std::string_view object) {
  if (handle) check(Close(handle.release()), call, object);
}

/// The HDF5 type of a C++ number in memory.
template <class T>
hid_t type_of() {
  if constexpr (std::is_same_v<T, std::int8_t>)
    return H5T_NATIVE_INT8;
  else if constexpr (std::is_same_v<T, std::uint8_t>)
    return H5T_NATIVE_UINT8;
  else if constexpr (std::is_same_v<T, std::int16_t>)
    return H5T_NATIVE_INT16;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return H5T_NATIVE_INT32;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return H5T_NATIVE_INT64;
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    return H5T_NATIVE_UINT64;
  else if constexpr (std::is_same_v<T, float>)
    return H5T_NATIVE_FLOAT;
  else {
    static_assert(std::is_same_v<T, double>, "no HDF5 type for this");
    return H5T_NATIVE_DOUBLE;
  }
}

/// UTF-8 text of exactly `bytes` bytes, padded with zeros.
Datatype text_type(std::size_t bytes);

/// `text`, truncated between characters or zero-padded to `bytes` bytes.
std::string fixed_text(std::string_view text, std::size_t bytes);

File create_file(const std::filesystem::path& path);  ///< fails if the path exists
File open_file(const std::filesystem::path& path, unsigned flags, hid_t access = H5P_DEFAULT);  ///< access: e.g. MPI-IO
PropertyList unlocked_access();  ///< file access with the default driver, without locks

/// Also creates missing parent groups. An empty `extent` is a scalar.
Dataset create_dataset(hid_t file, const std::string& path, hid_t type, const std::vector<hsize_t>& extent);
Dataset open_dataset(hid_t file, const std::string& path);
bool exists(hid_t file, const std::string& path);  ///< also false if a parent group is missing
std::vector<hsize_t> extent(const Dataset& dataset, const std::string& path);
/// Number of values. Throws Damage if fewer are stored: a damaged extent could exhaust the memory.
hsize_t value_count(const Dataset& dataset, const std::string& path);
bool is_contiguous(hid_t file, const std::string& path);  ///< false: in chunks, which may be compressed

/// An open dataset for access to rows [first, first + count); empty if `path` does not exist.
class RowDataset {
 public:
  RowDataset() = default;
  RowDataset(hid_t file, std::string path);

  explicit operator bool() const noexcept { return static_cast<bool>(dataset_); }
  const std::string& path() const { return path_; }
  hsize_t rows() const { return extent_.at(0); }
  hsize_t row_values() const { return row_values_; }
  Datatype type() const;  ///< type in the file
  void write(hid_t type, hsize_t first, hsize_t count, const void* values) const;
  void read(hid_t type, hsize_t first, hsize_t count, void* values) const;
  /// The single number or text of a row.
  template <class T>
  T number(hsize_t row) const;
  template <class T>
  void put(hsize_t row, T number) const;
  std::string text(hsize_t row) const;
  void put_text(hsize_t row, std::string_view text) const;

 private:
  Dataspace select(hsize_t first, hsize_t count) const;

  std::string path_;
  Dataset dataset_;
  Dataspace space_;
  std::vector<hsize_t> extent_;
  hsize_t row_values_ = 0;
};

template <class T>
T RowDataset::number(hsize_t row) const {
  if (row_values_ != 1) throw Damage(path_ + " has rows of several values");
  T value{};
  read(type_of<T>(), row, 1, &value);
  return value;
}

template <class T>
void RowDataset::put(hsize_t row, T number) const {
  write(type_of<T>(), row, 1, &number);
}

template <class T>
std::vector<T> read_all(hid_t file, const std::string& path) {
  const Dataset dataset = open_dataset(file, path);
  std::vector<T> values(value_count(dataset, path));
  check(H5Dread(dataset.id(), type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "H5Dread", path);
  return values;
}

template <class T>
void write_all(hid_t file, const std::string& path, const std::vector<T>& values) {
  const Dataset dataset = open_dataset(file, path);
  check(H5Dwrite(dataset.id(), type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "H5Dwrite", path);
}

/// Texts of a fixed length, read without their padding.
template <>
std::vector<std::string> read_all(hid_t file, const std::string& path);
void write_all(hid_t file, const std::string& path, const std::vector<std::string>& values);

void write_attribute(hid_t object, const char* name, std::string_view value);
void write_attribute(hid_t object, const char* name, std::int32_t value);

/// Creates a dataset with its values and the attributes unit and meaning.
template <class Values>
void store(hid_t file, const std::string& path, const std::vector<hsize_t>& extent, const Values& values,
           const char* unit, const char* meaning) {
  const hid_t type = type_of<typename Values::value_type>();
  const Dataset dataset = create_dataset(file, path, type, extent);
  check(H5Dwrite(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "H5Dwrite", path);
  write_attribute(dataset.id(), "unit", unit);
  write_attribute(dataset.id(), "meaning", meaning);
}
/// Creates a dataset of texts, as wide as the longest of them.
void store_texts(hid_t file, const std::string& path, const std::vector<std::string>& texts);

/// Calls visit(row, text) for each row, without all texts in memory. Throws Damage unless there are `rows` rows.
void visit_texts(hid_t file, const std::string& path, std::size_t rows,
                 const std::function<void(std::size_t, const std::string&)>& visit);
bool has_attribute(hid_t file, const std::string& object, const char* name);
std::string read_text_attribute(hid_t file, const std::string& object, const char* name);
std::int32_t read_int_attribute(hid_t file, const std::string& object, const char* name);

}  // namespace rodsweep::hdf5
