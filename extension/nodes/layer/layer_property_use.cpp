#include "nodes/layer/layer_property_use.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/variant/string.hpp>

#include <map>
#include <string>

using namespace godot;

namespace thicket {

namespace {

std::string text_of(const String &p_name) { return p_name.utf8().get_data(); }

/// Returns the uses of all properties by name. The map changes only while the class is registered,
/// so any thread may read it afterward.
std::map<std::string, PropertyUse> &property_uses() {
	static std::map<std::string, PropertyUse> uses;
	return uses;
}

} // namespace

void add_layer_property(
		PropertyUse use, const PropertyInfo &p_info, const StringName &p_setter, const StringName &p_getter) {
	property_uses()[text_of(String(p_info.name))] = use;
	ClassDB::add_property("ScatterLayer", p_info, p_setter, p_getter);
}

PropertyUse layer_property_use(const StringName &p_property) {
	const std::map<std::string, PropertyUse> &uses = property_uses();
	const auto entry = uses.find(text_of(String(p_property)));
	return entry == uses.end() ? PropertyUse::placement : entry->second;
}

} // namespace thicket
