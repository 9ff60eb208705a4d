#include "nodes/ground/former_grounds.hpp"

#include "nodes/common/renames.hpp"
#include "nodes/common/resource_file.hpp"
#include "nodes/ground/scatter_ground_colliders.hpp"
#include "nodes/ground/scatter_ground_flat.hpp"
#include "nodes/ground/scatter_ground_heightmap.hpp"
#include "nodes/ground/scatter_ground_meshes.hpp"
#include "nodes/ground/scatter_ground_node.hpp"
#include "nodes/ground/scatter_ground_noise.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/memory.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/dictionary.hpp>

#include <cstdint>

using namespace godot;

namespace thicket {

// docs/migration.md lists the same names, and a test compares the two lists.
#define THICKET_FORMER_GROUNDS(m_each) \
	m_each(ScatterTerrain, ScatterGround) m_each(ScatterTerrainColliders, ScatterGroundColliders) \
			m_each(ScatterTerrainFlat, ScatterGroundFlat) m_each(ScatterTerrainHeightmap, ScatterGroundHeightmap) \
					m_each(ScatterTerrainMeshes, ScatterGroundMeshes) m_each(ScatterTerrainNoise, ScatterGroundNoise) \
							m_each(ScatterTerrainObject, ScatterGroundNode)

// NOLINTBEGIN(bugprone-macro-parentheses): class names take no parentheses.
#define THICKET_DECLARE(m_former, m_current) \
	class m_former : public m_current { \
		GDCLASS(m_former, m_current) \
\
	protected: \
		static void _bind_methods() {} \
	};
THICKET_FORMER_GROUNDS(THICKET_DECLARE)
#undef THICKET_DECLARE
// NOLINTEND(bugprone-macro-parentheses)

namespace {

/// The name of the metadata in which a former ground stores its replacement.
constexpr const char *successor_meta = "thicket_successor";

/// Creates a ground of the class that replaces the former class of `p_ground`. Returns null for a
/// ground of a current class, and for one with a script, whose base class cannot change.
Ref<ScatterGround> make_successor(const ScatterGround &p_ground) {
	const String name = p_ground.get_class();
	const bool is_scripted = p_ground.get("script").get_type() == Variant::OBJECT;
#define THICKET_MAKE(m_former, m_current) \
	if (name == String(#m_former)) { \
		if (is_scripted) { \
			warn_of_base(#m_former, #m_current); \
			return Ref<ScatterGround>(); \
		} \
		warn_of_rename(#m_former, #m_current); \
		return Ref<ScatterGround>(memnew(m_current)); \
	}
	THICKET_FORMER_GROUNDS(THICKET_MAKE)
#undef THICKET_MAKE
	return Ref<ScatterGround>();
}

} // namespace

void register_former_grounds() {
#define THICKET_REGISTER(m_former, m_current) GDREGISTER_VIRTUAL_CLASS(m_former);
	THICKET_FORMER_GROUNDS(THICKET_REGISTER)
#undef THICKET_REGISTER
}

Ref<ScatterGround> current_ground(const Ref<ScatterGround> &p_ground) {
	if (p_ground.is_null()) {
		return p_ground;
	}
	// Nodes that shared the former ground must share its replacement.
	if (static_cast<bool>(p_ground->call("has_meta", successor_meta))) {
		return p_ground->call("get_meta", successor_meta);
	}
	Ref<ScatterGround> successor = make_successor(*p_ground.ptr());
	if (successor.is_null()) {
		return p_ground;
	}
	const Array properties = p_ground->call("get_property_list");
	for (std::int64_t i = 0; i < properties.size(); ++i) {
		const Dictionary property = properties[i];
		const std::int64_t usage = property["usage"];
		if ((usage & PROPERTY_USAGE_STORAGE) != 0) {
			successor->call("set", property["name"], p_ground->get(property["name"]));
		}
	}
	p_ground->call("set_meta", successor_meta, successor);
	const String path = p_ground->get_path();
	if (is_own_file(path)) {
		successor->call("take_over_path", path);
	}
	return successor;
}

} // namespace thicket
