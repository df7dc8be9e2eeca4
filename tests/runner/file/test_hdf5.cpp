#include <fstream>

#include "runner/file/hdf5.hpp"
#include "tests/catch.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("a handle that is moved or assigned leaves its source empty, and each is closed once") {
  hdf5::Dataspace a(H5Screate(H5S_SCALAR)), b(H5Screate(H5S_SCALAR));
  const hid_t old = a.id(), kept = b.id();
  a = std::move(b);
  CHECK_FALSE(b);
  CHECK(H5Iis_valid(old) == 0);
  CHECK(a.id() == kept);
  {
    const hdf5::Dataspace c(std::move(a));
    CHECK_FALSE(a);
    CHECK(c.id() == kept);
    CHECK(H5Iis_valid(kept) > 0);
  }
  CHECK(H5Iis_valid(kept) == 0);
}

TEST_CASE("a failing HDF5 call is named, with its object and HDF5's own text") {
  const TemporaryFolder folder;
  const hdf5::File file = hdf5::create_file(folder / "a.h5");
  const std::string text = message_of<Hdf5Error>([&] { hdf5::open_dataset(file.id(), "/tasks/state"); });
  CHECK_THAT(text, ContainsSubstring("H5Dopen2 failed on /tasks/state") && ContainsSubstring("component not found"));
}

TEST_CASE("a new HDF5 file never takes the place of another") {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.h5") << "precious";
  CHECK_THROWS_AS(hdf5::create_file(folder / "a.h5"), Hdf5Error);
  CHECK(bytes_of(folder / "a.h5") == "precious");
}

TEST_CASE("text of a fixed length is padded with zeros and never cut within a character") {
  CHECK(hdf5::fixed_text("abc", 5) == std::string("abc\0\0", 5));
  CHECK(hdf5::fixed_text("abcdef", 3) == "abc");
  CHECK(hdf5::fixed_text("ab\xC3\xA4", 3) == std::string("ab\0", 3));
  CHECK(hdf5::fixed_text("ab\xC3\xA4", 4) == "ab\xC3\xA4");
  CHECK(hdf5::fixed_text("", 2) == std::string(2, '\0'));
}

TEST_CASE("rows of a dataset are written and read without touching their neighbours") {
  const TemporaryFolder folder;
  const hdf5::File file = hdf5::create_file(folder / "a.h5");
  hdf5::create_dataset(file.id(), "/x", hdf5::type_of<double>(), {4, 3});
  hdf5::write_all(file.id(), "/x", std::vector<double>(12, -1));
  const hdf5::RowDataset rows(file.id(), "/x");
  REQUIRE(rows);
  CHECK(rows.row_values() == 3);
  const std::vector<double> two{1, 2, 3, 4, 5, 6};
  rows.write(hdf5::type_of<double>(), 1, 2, two.data());
  CHECK(hdf5::read_all<double>(file.id(), "/x") == std::vector<double>{-1, -1, -1, 1, 2, 3, 4, 5, 6, -1, -1, -1});
  std::vector<double> one(3);
  rows.read(hdf5::type_of<double>(), 2, 1, one.data());
  CHECK(one == std::vector<double>{4, 5, 6});
  CHECK_THROWS_AS(rows.write(hdf5::type_of<double>(), 3, 2, two.data()), Hdf5Error);
  CHECK_FALSE(hdf5::RowDataset(file.id(), "/group/y"));
}

namespace {

/// Creates /x of `rows` numbers in chunks of a thousand; without filters if `deflations` is 0.
void create_chunked(const hdf5::File& file, hsize_t rows, int deflations) {
  const hdf5::PropertyList creation(H5Pcreate(H5P_DATASET_CREATE));
  const hsize_t chunk = 1000, most = H5S_UNLIMITED;
  H5Pset_chunk(creation.id(), 1, &chunk);
  for (int i = 0; i < deflations; ++i) H5Pset_deflate(creation.id(), 9);
  const hdf5::Dataspace space(H5Screate_simple(1, &rows, &most));
  const hdf5::Dataset made(
      H5Dcreate2(file.id(), "/x", H5T_NATIVE_DOUBLE, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT));
  hdf5::write_all(file.id(), "/x", std::vector<double>(rows, 0));
}

}  // namespace

TEST_CASE("compressed values are read, however few bytes they take") {
  const TemporaryFolder folder;
  const hdf5::File file = hdf5::create_file(folder / "a.h5");
  create_chunked(file, 100'000, 2);
  CHECK(H5Dget_storage_size(hdf5::open_dataset(file.id(), "/x").id()) < 4'000);
  CHECK(hdf5::RowDataset(file.id(), "/x").rows() == 100'000);
  CHECK(hdf5::read_all<double>(file.id(), "/x").size() == 100'000);
}

TEST_CASE("a shape that is larger than the data is damage, in chunks and in one piece") {
  const TemporaryFolder folder;
  const hdf5::File file = hdf5::create_file(folder / "a.h5");
  const hsize_t larger = 3'000;
  create_chunked(file, 2'500, 1);
  {
    const hdf5::Dataset x = hdf5::open_dataset(file.id(), "/x");
    CHECK(hdf5::value_count(x, "/x") == 2'500);
    H5Dset_extent(x.id(), &larger);  // the last chunk has room
    CHECK(hdf5::value_count(x, "/x") == 3'000);
    const hsize_t damaged = hsize_t{1} << 50;
    H5Dset_extent(x.id(), &damaged);
  }
  CHECK_THAT(message_of<Damage>([&] { hdf5::read_all<double>(file.id(), "/x"); }), ContainsSubstring("/x has a shape"));
  CHECK_THAT(message_of<Damage>([&] { hdf5::RowDataset(file.id(), "/x"); }), ContainsSubstring("larger than its data"));

  const hdf5::Dataspace space(H5Screate_simple(1, &larger, nullptr));  // nothing is allocated before the first write
  const hdf5::Dataset unwritten(
      H5Dcreate2(file.id(), "/y", H5T_NATIVE_DOUBLE, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  CHECK_THROWS_AS(hdf5::value_count(unwritten, "/y"), Damage);
}

TEST_CASE("texts are visited one by one, across blocks") {
  const TemporaryFolder folder;
  const hdf5::File file = hdf5::create_file(folder / "a.h5");
  constexpr std::size_t rows = (1 << 14) + 2;
  hdf5::create_dataset(file.id(), "/x", hdf5::text_type(8).id(), {rows});
  std::vector<std::string> texts(rows, "same");
  texts.front() = "first", texts.back() = "last";
  hdf5::write_all(file.id(), "/x", texts);
  std::vector<std::string> seen;
  hdf5::visit_texts(file.id(), "/x", rows, [&](std::size_t row, const std::string& text) {
    CHECK(row == seen.size());
    seen.push_back(text);
  });
  CHECK(seen == texts);
  CHECK_THROWS_AS(hdf5::visit_texts(file.id(), "/x", rows + 1, [](std::size_t, const std::string&) {}), Damage);
}
