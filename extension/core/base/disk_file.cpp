#include "core/base/disk_file.hpp"

#if defined(_WIN32)
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>

#include <algorithm>
#elif !defined(__wasm__)
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#endif

namespace thicket {

#if defined(_WIN32)

namespace {

/// Converts a path to the form that Windows expects, even if it is longer than 260 characters.
std::wstring native_path(const std::string &path) {
	const int size = MultiByteToWideChar(CP_UTF8, 0, path.c_str(), -1, nullptr, 0);
	std::wstring result(static_cast<std::size_t>(std::max(size, 1)), L'\0');
	MultiByteToWideChar(CP_UTF8, 0, path.c_str(), -1, result.data(), size);
	result.pop_back(); // Removes the terminating zero.
	std::replace(result.begin(), result.end(), L'/', L'\\');
	const bool has_drive = result.size() > 2 && result[1] == L':';
	return has_drive ? L"\\\\?\\" + result : result;
}

} // namespace

std::string resolved_path(const std::string &path) { return path; }

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

#elif defined(__wasm__)

std::string resolved_path(const std::string &path) { return path; }

bool can_be_replaced(const std::string & /*path*/) { return true; }

bool sync_file(const std::string & /*path*/, const std::string & /*replaced*/) { return true; }

bool move_over(const std::string & /*from*/, const std::string & /*to*/) { return false; }

#else

std::string resolved_path(const std::string &path) {
	const std::unique_ptr<char, decltype(&std::free)> target(realpath(path.c_str(), nullptr), &std::free);
	return target != nullptr ? std::string(target.get()) : path;
}

bool can_be_replaced(const std::string &path) {
	struct stat found = {};
	return stat(path.c_str(), &found) != 0 || (S_ISREG(found.st_mode) && access(path.c_str(), W_OK) == 0);
}

bool sync_file(const std::string &path, const std::string &replaced) {
	const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
	if (file < 0) {
		return false;
	}
	struct stat before = {};
	if (stat(replaced.c_str(), &before) == 0) {
		// Failure is ignored, because some file systems have no permissions.
		static_cast<void>(fchmod(file, before.st_mode & 07777U));
	}
#ifdef F_FULLFSYNC
	// On macOS, fsync leaves the data in the disk's cache.
	const bool synced = fcntl(file, F_FULLFSYNC) == 0 || fsync(file) == 0;
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
	const int folder_handle = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_CLOEXEC);
	if (folder_handle >= 0) {
		// Failure is ignored, because some systems cannot sync folders and the file is already moved.
		static_cast<void>(fsync(folder_handle));
		close(folder_handle);
	}
	return true;
}

#endif

} // namespace thicket
