// Tests the atomic replacement of files: the content is complete, links and permissions are
// preserved, and only regular files are replaced.

#include "core/base/disk_file.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

using namespace thicket;
namespace fs = std::filesystem;

namespace {

/// A temporary folder that the destructor removes.
struct Folder {
	fs::path path = fs::temp_directory_path() / "thicket_disk_file";

	Folder() {
		fs::remove_all(path);
		fs::create_directories(path);
	}
	~Folder() { fs::remove_all(path); }
	Folder(const Folder &) = delete;
	Folder &operator=(const Folder &) = delete;

	std::string of(const char *name) const { return (path / name).string(); }
	void write(const char *name, const std::string &text) const { std::ofstream(path / name) << text; }
	std::string read(const char *name) const {
		std::ifstream file(path / name);
		return {std::istreambuf_iterator<char>(file), {}};
	}
};

} // namespace

TEST_CASE("a file replaces an existing file") {
	if (!has_disk) {
		return;
	}
	const Folder folder;
	folder.write("new", "what is new");
	CHECK(sync_file(folder.of("new"), folder.of("old")));
	CHECK(move_over(folder.of("new"), folder.of("old")));
	CHECK(folder.read("old") == "what is new");
	folder.write("new", "newer");
	CHECK(sync_file(folder.of("new"), folder.of("old")));
	CHECK(move_over(folder.of("new"), folder.of("old")));
	CHECK(folder.read("old") == "newer");
	CHECK_FALSE(fs::exists(folder.path / "new"));
}

TEST_CASE("a file that cannot be moved stays in place") {
	if (!has_disk) {
		return;
	}
	const Folder folder;
	folder.write("old", "old");
	CHECK_FALSE(sync_file(folder.of("missing"), folder.of("old")));
	CHECK_FALSE(move_over(folder.of("missing"), folder.of("old")));
	CHECK_FALSE(move_over(folder.of("old"), folder.of("missing/old")));
	CHECK(folder.read("old") == "old");
}

TEST_CASE("only files can be replaced") {
	if (!has_disk) {
		return;
	}
	const Folder folder;
	folder.write("old", "old");
	CHECK(can_be_replaced(folder.of("old")));
	CHECK(can_be_replaced(folder.of("missing")));
	CHECK_FALSE(can_be_replaced(folder.path.string()));
}
