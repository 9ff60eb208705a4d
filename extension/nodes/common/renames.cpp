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
	const char *former;
	const char *current;
};

// docs/migration.md lists the same names, and a test compares the two lists.
constexpr RenamedProperty renamed_properties[] = {
		{"ScatterLayer", "slope_falloff", "slope_falloff_degrees"},
		{"ScatterLayer", "thin_scale_compensation", "thin_scale_up"},
		{"ScatterState", "designed", "copy_at_runtime"},
		{"TerrainScatter3D", "terrain", "ground"},
};

bool is_first_warning(const char *p_former) {
	static std::mutex mutex;
	static std::set<std::string> warned;
	const std::lock_guard lock(mutex);
	return warned.insert(p_former).second;
}

} // namespace

void warn_of_rename(const char *p_former, const char *p_current) {
	warn_of_change(p_former, (std::string("is named ") + p_current).c_str());
}

void warn_of_change(const char *p_former, const char *p_change) {
	if (is_first_warning(p_former)) {
		WARN_PRINT(
				vformat("%s %s since version 0.3. The file was read as before. Open and save it in the editor to store "
						"the new name.",
						p_former, p_change));
	}
}

void warn_of_base(const char *p_former, const char *p_current) {
	if (is_first_warning((std::string("extends ") + p_former).c_str())) { // Files may use the same name.
		WARN_PRINT(vformat(
				"%s is named %s since version 0.3, and a script extends %s. It runs as before. Change the script "
				"to extend %s.",
				p_former, p_current, p_former, p_current));
	}
}

void warn_of_removal(const char *p_former, const char *p_remedy) {
	if (is_first_warning(p_former)) {
		WARN_PRINT(vformat("%s has no effect since version 0.3. %s. Open and save the file in the editor to remove it.",
				p_former, p_remedy));
	}
}

bool set_renamed(Object *p_object, const StringName &p_name, const Variant &p_value) {
	for (const RenamedProperty &property : renamed_properties) {
		if (p_name == StringName(property.former) && p_object->is_class(property.owner)) {
			const std::string owner = std::string(property.owner) + ".";
			warn_of_rename((owner + property.former).c_str(), (owner + property.current).c_str());
			p_object->call("set", property.current, p_value);
			return true;
		}
	}
	return false;
}

} // namespace thicket
