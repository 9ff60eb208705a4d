#include "nodes/common/file_replace.hpp"

#include "core/base/disk_file.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/classes/dir_access.hpp>
#include <godot_cpp/classes/file_access.hpp>
#include <godot_cpp/classes/project_settings.hpp>
#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/char_string.hpp>

#include <string>
#include <string_view>

using namespace godot;

namespace thicket {

namespace {

std::string system_path(const String &p_path) {
	const String path = ProjectSettings::get_singleton()->globalize_path(p_path);
	return path.utf8().get_data();
}

/// Writes all bytes or returns an error. FileAccess.close() reports no error, so the file's length
/// is checked to detect a full disk.
Error store(const String &p_path, const PackedByteArray &p_bytes) {
	Ref<FileAccess> file = FileAccess::open(p_path, FileAccess::WRITE);
	if (file.is_null()) {
		return FileAccess::get_open_error();
	}
	const bool is_stored = file->store_buffer(p_bytes);
	file->flush();
	const Error error = file->get_error();
	file->close();
	if (!is_stored || error != OK) {
		return ERR_FILE_CANT_WRITE;
	}
	file = FileAccess::open(p_path, FileAccess::READ);
	const bool is_complete = file.is_valid() && file->get_length() == static_cast<std::uint64_t>(p_bytes.size());
	return is_complete ? OK : ERR_FILE_CANT_WRITE;
}

/// Returns true for files written by ResourceSaver: binary, compressed or text.
bool is_resource_file(const PackedByteArray &p_bytes) {
	const std::string_view text(
			reinterpret_cast<const char *>(p_bytes.ptr()), static_cast<std::size_t>(p_bytes.size()));
	const auto has_prefix = [text](std::string_view prefix) {
		return text.starts_with(prefix);
	};
	return has_prefix("RSRC") || has_prefix("RSCC") || has_prefix("[gd_");
}

Error report_failure(
		const char *p_method, const char *p_action, const String &p_path, const char *p_reason, Error p_error) {
	ERR_PRINT(vformat("%s: cannot %s %s: %s", p_method, p_action, p_path, p_reason));
	return p_error == OK ? FAILED : p_error;
}

} // namespace

Error replace_file(const char *p_method, const String &p_path, const PackedByteArray &p_bytes) {
	const std::string path = resolved_path(system_path(p_path));
	const auto fail = [&](const char *p_reason, Error p_error) {
		return report_failure(p_method, "write", p_path, p_reason, p_error);
	};
	if (path.empty()) {
		return fail("the path is empty. Pass one such as user://forest.state", ERR_FILE_BAD_PATH);
	}
	if (!can_be_replaced(path)) {
		return fail("the path is not a file, or the file is read-only. Choose another path, or make the file writable",
				ERR_FILE_NO_PERMISSION);
	}
	const std::string partial_path = path + ".part";
	const String engine_partial_path = String::utf8(partial_path.c_str());
	const Error error = store(engine_partial_path, p_bytes);
	if (error != OK && error != ERR_FILE_CANT_WRITE) {
		return fail("its folder is missing or read-only. Create the folder with "
					"DirAccess.make_dir_recursive_absolute(), or choose another folder",
				error);
	}
	const char *reason = nullptr;
	if (error != OK || !sync_file(partial_path, path)) {
		reason = "the disk is full or has failed. Free space there, or choose another disk. The old file is unchanged";
	} else if (!(has_disk ? move_over(partial_path, path)
						  : DirAccess::rename_absolute(engine_partial_path, String::utf8(path.c_str())) == OK)) {
		reason = "the new file cannot replace it. Close programs that have it open. The old file is unchanged";
	}
	if (reason != nullptr) {
		DirAccess::remove_absolute(engine_partial_path);
		return fail(reason, ERR_FILE_CANT_WRITE);
	}
	return OK;
}

Error load_saved_file(const char *p_method, const String &p_path,
		const std::function<Status(std::span<const std::uint8_t> bytes)> &load) {
	const auto fail = [&](const char *p_reason, Error p_error) {
		return report_failure(p_method, "load", p_path, p_reason, p_error);
	};
	if (!FileAccess::file_exists(p_path)) {
		return fail("there is no such file. Save one with save_to_file(), or call FileAccess.file_exists() first",
				ERR_FILE_NOT_FOUND);
	}
	const PackedByteArray bytes = FileAccess::get_file_as_bytes(p_path);
	const Error error = FileAccess::get_open_error();
	if (error != OK) {
		return fail("the game has no permission to read it. Change the permissions of the file", error);
	}
	if (is_resource_file(bytes)) {
		return fail(
				"it is a Godot resource, but load_from_file() reads only files from save_to_file(). If you trust it, "
				"load it with ResourceLoader once and save it with save_to_file()",
				ERR_FILE_UNRECOGNIZED);
	}
	const Status status = load(span_of(bytes));
	return status.ok() ? OK : fail(describe(status).c_str(), error_of(status));
}

} // namespace thicket
