#include "nodes/common/file_replace.hpp"

#include <godot_cpp/classes/dir_access.hpp>
#include <godot_cpp/classes/file_access.hpp>
#include <godot_cpp/classes/project_settings.hpp>
#include <godot_cpp/variant/char_string.hpp>

#include <string>
#include <string_view>

#if defined(_WIN32)
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>

#include <algorithm>
#elif !defined(WEB_ENABLED)
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#endif

using namespace godot;

namespace thicket {

namespace {

// The engine writes files, but neither waits for the disk nor, on Windows, replaces a file in one step. These do, with paths in UTF-8.

#if defined(_WIN32)

/// As the system wants it, also where it is longer than 260 characters.
std::wstring native_path(const std::string &path) {
	const int size = MultiByteToWideChar(CP_UTF8, 0, path.c_str(), -1, nullptr, 0);
	std::wstring result(static_cast<std::size_t>(std::max(size, 1)), L'\0');
	MultiByteToWideChar(CP_UTF8, 0, path.c_str(), -1, result.data(), size);
	result.pop_back(); // The end of the string.
	std::replace(result.begin(), result.end(), L'/', L'\\');
	const bool has_drive = result.size() > 2 && result[1] == L':';
	return has_drive ? L"\\\\?\\" + result : result;
}

std::string resolved(const std::string &path) { return path; }

bool can_be_replaced(const std::string &path) {
	const DWORD attributes = GetFileAttributesW(native_path(path).c_str());
	return attributes == INVALID_FILE_ATTRIBUTES ||
			(attributes & (FILE_ATTRIBUTE_DIRECTORY | FILE_ATTRIBUTE_READONLY | FILE_ATTRIBUTE_DEVICE)) == 0;
}

bool sync_file(const std::string &path, const std::string & /*replaced*/) {
	void *file = CreateFileW(native_path(path).c_str(), GENERIC_WRITE, FILE_SHARE_READ, nullptr, OPEN_EXISTING,
			FILE_ATTRIBUTE_NORMAL, nullptr);
	if (file == INVALID_HANDLE_VALUE) {
		return false;
	}
	const bool synced = FlushFileBuffers(file) != 0;
	return CloseHandle(file) != 0 && synced;
}

bool move_over(const std::string &from, const std::string &to) {
	return MoveFileExW(native_path(from).c_str(), native_path(to).c_str(),
				   MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH) != 0;
}

#elif !defined(WEB_ENABLED)

/// The file that a link leads to: the link itself is to stay.
std::string resolved(const std::string &path) {
	const std::unique_ptr<char, decltype(&std::free)> target(realpath(path.c_str(), nullptr), &std::free);
	return target != nullptr ? std::string(target.get()) : path;
}

/// False for folders, devices and files that may not be written: the folder alone would let any of them be replaced.
bool can_be_replaced(const std::string &path) {
	struct stat found = {};
	return stat(path.c_str(), &found) != 0 || (S_ISREG(found.st_mode) && access(path.c_str(), W_OK) == 0);
}

/// Waits until the disk has the file, and gives it the permissions of the one that it replaces.
bool sync_file(const std::string &path, const std::string &replaced) {
	const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
	if (file < 0) {
		return false;
	}
	struct stat before = {};
	if (stat(replaced.c_str(), &before) == 0) {
		static_cast<void>(fchmod(file, before.st_mode & 07777U)); // Some disks know no permissions.
	}
#ifdef F_FULLFSYNC
	const bool synced =
			fcntl(file, F_FULLFSYNC) == 0 || fsync(file) == 0; // On macOS fsync leaves it in the disk's own memory.
#else
	const bool synced = fsync(file) == 0;
#endif
	return close(file) == 0 && synced;
}

bool move_over(const std::string &from, const std::string &to) {
	if (std::rename(from.c_str(), to.c_str()) != 0) {
		return false;
	}
	const std::string folder = to.substr(0, to.rfind('/') + 1);
	const int opened = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_CLOEXEC);
	if (opened >= 0) {
		static_cast<void>(
				fsync(opened)); // Some systems refuse this for folders; the file is in its place all the same.
		close(opened);
	}
	return true;
}

#else

// In a browser the engine keeps files in memory, and copies them to the browser's store after it has closed one.
std::string resolved(const std::string &path) { return path; }

bool can_be_replaced(const std::string & /*path*/) { return true; }

bool sync_file(const std::string & /*path*/, const std::string & /*replaced*/) { return true; }

bool move_over(const std::string &from, const std::string &to) {
	return DirAccess::rename_absolute(String::utf8(from.c_str()), String::utf8(to.c_str())) == OK;
}

#endif

std::string system_path(const String &p_path) {
	const String path = ProjectSettings::get_singleton()->globalize_path(p_path);
	return path.utf8().get_data();
}

/// Writes all of it, or has an error. Closing reports none, so the length tells whether it has found room for the last bytes.
Error store(const String &p_path, const PackedByteArray &p_bytes) {
	Ref<FileAccess> file = FileAccess::open(p_path, FileAccess::WRITE);
	if (file.is_null()) {
		return FileAccess::get_open_error();
	}
	const bool stored = file->store_buffer(p_bytes);
	file->flush();
	const Error error = file->get_error();
	file->close();
	if (!stored || error != OK) {
		return ERR_FILE_CANT_WRITE;
	}
	file = FileAccess::open(p_path, FileAccess::READ);
	const bool whole = file.is_valid() && file->get_length() == static_cast<std::uint64_t>(p_bytes.size());
	return whole ? OK : ERR_FILE_CANT_WRITE;
}

/// Whether ResourceSaver wrote it, as binary, compressed or as text.
bool is_resource_file(const PackedByteArray &p_bytes) {
	const std::string_view text(
			reinterpret_cast<const char *>(p_bytes.ptr()), static_cast<std::size_t>(p_bytes.size()));
	const auto begins = [text](std::string_view begin) {
		return text.starts_with(begin);
	};
	return begins("RSRC") || begins("RSCC") || begins("[gd_");
}

Error refuse(const char *p_deed, const String &p_path, const char *p_why, Error p_error, String &r_problem) {
	r_problem = vformat("cannot %s %s: %s", p_deed, p_path, p_why);
	return p_error == OK ? FAILED : p_error;
}

} // namespace

Error replace_file(const String &p_path, const PackedByteArray &p_bytes, String &r_problem) {
	const std::string path = resolved(system_path(p_path));
	const auto failed = [&](const char *p_why, Error p_error) {
		return refuse("write", p_path, p_why, p_error, r_problem);
	};
	if (path.empty()) {
		return failed("the path is empty. Pass one such as user://forest.state", ERR_FILE_BAD_PATH);
	}
	if (!can_be_replaced(path)) {
		return failed(
				"what is there is no file, or may not be written. Choose a different path, or let the file be written",
				ERR_FILE_NO_PERMISSION);
	}
	const std::string partial = path + ".part";
	const String beside = String::utf8(partial.c_str());
	const Error error = store(beside, p_bytes);
	if (error != OK && error != ERR_FILE_CANT_WRITE) {
		return failed("its folder is missing or may not be written. Make the folder with "
					  "DirAccess.make_dir_recursive_absolute(), or choose a different one",
				error);
	}
	const char *why = nullptr;
	if (error != OK || !sync_file(partial, path)) {
		why = "the disk is full or has failed. Free space there, or choose a different disk. The old file is as it was";
	} else if (!move_over(partial, path)) {
		why = "the new file cannot take its place. Close programs that have it open. The old file is as it was";
	}
	if (why != nullptr) {
		DirAccess::remove_absolute(beside);
		return failed(why, ERR_FILE_CANT_WRITE);
	}
	return OK;
}

Error read_saved_file(const String &p_path, PackedByteArray &r_bytes, String &r_problem) {
	const auto failed = [&](const char *p_why, Error p_error) {
		return refuse("load", p_path, p_why, p_error, r_problem);
	};
	if (!FileAccess::file_exists(p_path)) {
		return failed("there is no such file. Save one with save_to_file(), or call FileAccess.file_exists() first",
				ERR_FILE_NOT_FOUND);
	}
	PackedByteArray bytes = FileAccess::get_file_as_bytes(p_path);
	const Error error = FileAccess::get_open_error();
	if (error != OK) {
		return failed("it may not be read. Let the game read it", error);
	}
	if (is_resource_file(bytes)) {
		return failed(
				"it is a resource of Godot, and load_from_file() reads files of save_to_file() only. If you trust it, "
				"load it with ResourceLoader once, and save it with save_to_file()",
				ERR_FILE_UNRECOGNIZED);
	}
	r_bytes = bytes;
	return OK;
}

} // namespace thicket
