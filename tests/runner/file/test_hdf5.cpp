#include <catch2/catch.hpp>
#include <fstream>

#include "runner/file/hdf5.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::Contains;

TEST_CASE("a moved handle leaves its source empty and is closed once") {
  hdf5::Dataspace a(H5Screate(H5S_SCALAR));
  const hid_t id = a.id();
  {
    hdf5::Dataspace b(std::move(a));
    CHECK_FALSE(a);
    CHECK(b.id() == id);
    CHECK(H5Iis_valid(id) > 0);
  }
  CHECK(H5Iis_valid(id) == 0);
}

TEST_CASE("assigning a handle closes the old one and keeps the new one") {
  hdf5::Dataspace a(H5Screate(H5S_SCALAR)), b(H5Screate(H5S_SCALAR));
  const hid_t old = a.id(), kept = b.id();
  a = std::move(b);
  CHECK(H5Iis_valid(old) == 0);
  CHECK(a.id() == kept);
  CHECK(H5Iis_valid(kept) > 0);
  CHECK_FALSE(b);
}

TEST_CASE("a failing HDF5 call is named, with its object and HDF5's own text") {
  const TemporaryFolder folder;
  const hdf5::File file = hdf5::create_file(folder / "a.h5");
  const std::string text = message_of<Hdf5Error>([&] { hdf5::open_dataset(file.id(), "/tasks/state"); });
  CHECK_THAT(text, Contains("H5Dopen2 failed on /tasks/state") && Contains("component not found"));
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
