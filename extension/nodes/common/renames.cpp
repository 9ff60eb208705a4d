#include "nodes/common/renames.hpp"

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/string.hpp>

#include <mutex>
#include <set>
#include <string>

using namespace godot;

namespace thicket {

namespace {

struct RenamedProperty {
	const char *owner;
	const char *old_name;
	const char *new_name;
};

// docs/migration.md lists the same names, and a test compares the two lists.
constexpr RenamedProperty renamed_properties[] = {
		{"ScatterLayer", "slope_falloff", "slope_falloff_degrees"},
		{"ScatterLayer", "thin_scale_compensation", "thin_scale_up"},
		{"ScatterState", "designed", "copy_at_runtime"},
		{"TerrainScatter3D", "terrain", "ground"},
};

bool is_first_warning(const char *p_old_name) {
	static std::mutex mutex;
	static std::set<std::string> warned_names;
	const std::lock_guard lock(mutex);
	return warned_names.insert(p_old_name).second;
}

} // namespace

void warn_of_rename(const char *p_old_name, const char *p_new_name) {
	warn_of_change(p_old_name, (std::string("is named ") + p_new_name).c_str());
}

void warn_of_change(const char *p_old_name, const char *p_change) {
	if (is_first_warning(p_old_name)) {
		WARN_PRINT(
				vformat("%s %s since version 0.3. The file was read as before. Open and save it in the editor to store "
						"the new name.",
						p_old_name, p_change));
	}
}

void warn_of_base(const char *p_old_name, const char *p_new_name) {
	if (is_first_warning((std::string("extends ") + p_old_name).c_str())) { // Files may use the same name.
		WARN_PRINT(vformat(
				"%s is named %s since version 0.3, and a script extends %s. It runs as before. Change the script "
				"to extend %s.",
				p_old_name, p_new_name, p_old_name, p_new_name));
	}
}

void warn_of_removal(const char *p_old_name, const char *p_remedy) {
	if (is_first_warning(p_old_name)) {
		WARN_PRINT(vformat("%s has no effect since version 0.3. %s. Open and save the file in the editor to remove it.",
				p_old_name, p_remedy));
	}
}

bool set_renamed(Object *p_object, const StringName &p_name, const Variant &p_value) {
	for (const RenamedProperty &property : renamed_properties) {
		if (p_name == StringName(property.old_name) && p_object->is_class(property.owner)) {
			const std::string owner = std::string(property.owner) + ".";
			warn_of_rename((owner + property.old_name).c_str(), (owner + property.new_name).c_str());
			p_object->call("set", property.new_name, p_value);
			return true;
		}
	}
	return false;
}

} // namespace thicket
