#pragma once

#include "core/drawing/cell_choice.hpp"
#include "core/drawing/lod.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/layer_links.hpp"
#include "core/query/instance_query.hpp"
#include "core/rows/row_set.hpp"
#include "core/streaming/tile_streamer.hpp"
#include "nodes/model/body_part.hpp"
#include "nodes/model/scatter_lod.hpp"

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/packed_scene.hpp>
#include <godot_cpp/variant/aabb.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace thicket {

/// The shadow of a drawn mesh.
struct MeshShadow {
	/// The mesh that casts the shadow in place of the drawn mesh. Null if the drawn mesh casts it.
	godot::Ref<godot::Mesh> mesh;
	std::int64_t setting = -1; ///< A GeometryInstance3D.ShadowCastingSetting, or one of the values below.

	static constexpr std::int64_t as_layer = -1; ///< The layer's setting.
	/// Off if the layer's setting is "On" (the default); otherwise the layer's setting.
	static constexpr std::int64_t as_layer_unless_on = -2;

	/// Returns the effective setting in a layer with `layer_setting`.
	std::int64_t setting_in(std::int64_t layer_setting) const {
		constexpr std::int64_t off = 0;
		constexpr std::int64_t on = 1;
		const bool is_off = setting == as_layer_unless_on && layer_setting == on;
		return is_off ? off : setting < 0 ? layer_setting : setting;
	}

	friend bool operator==(const MeshShadow &, const MeshShadow &) = default;
};

/// A mesh and the settings to draw it with.
struct MeshAppearance {
	godot::Ref<godot::Mesh> mesh;
	MeshShadow shadow;
	LodAppearance lod_appearance;
	bool fades = false; ///< True if the mesh can fade; see add_fades.

	/// Returns true if both have the same mesh and shadow. Their `lod_appearance` (density,
	/// transparency and shader parameters) may differ.
	bool same_meshes(const MeshAppearance &other) const { return mesh == other.mesh && shadow == other.shadow; }

	friend bool operator==(const MeshAppearance &, const MeshAppearance &) = default;
};

/// The meshes of a layer's instances, and the renderer settings to draw them with. Integers are
/// values of the engine's enumerations.
struct LayerDrawing {
	/// The finest mesh of each entry of the layer's `meshes`. A null mesh draws nothing.
	std::vector<MeshAppearance> meshes;

	/// One row per LOD distance, with an element for each of `meshes`. A null mesh means that the
	/// next finer LOD is drawn.
	std::vector<MeshAppearance> lod_meshes;

	/// The material IDs and vertex counts of the surfaces of all meshes that can fade. A difference
	/// means that a resource has changed, even if it is the same object.
	std::vector<std::uint64_t> surfaces;

	/// The bounding box of each mesh when the snapshot was created. If the box differs, the mesh
	/// has changed, even if it is the same resource.
	std::vector<godot::AABB> boxes;

	/// The reach of each mesh: the distance in meters, at scale 1, from its origin to its farthest
	/// corner, over all its LODs. The reach includes the largest factor by which thinning may
	/// enlarge instances.
	std::vector<float> mesh_reach;

	/// The edge length of a cell in meters. 0 selects a size that fits the models;
	/// LayerSnapshot::cells has the result.
	double draw_cell_size = 0.0;

	/// The material that replaces all others. Null if the meshes keep their materials.
	godot::Ref<godot::Material> material_override;
	std::int64_t cast_shadow = 1;
	std::int64_t gi_mode = 1;
	std::int64_t render_layers = 1;
	double lod_bias = 1.0;
	/// The distance in meters by which bounds are enlarged for culling. In a snapshot, it is the
	/// property plus sway_reach of the materials.
	double extra_cull_margin = 0.0;

	/// Returns true if the entry at this index has a mesh.
	bool draws(std::size_t mesh) const { return mesh < meshes.size() && meshes[mesh].mesh.is_valid(); }
	float reach_of(std::size_t mesh) const { return mesh < mesh_reach.size() ? mesh_reach[mesh] : 0.0F; }

	/// Returns true if both draw the same meshes, so that existing tiles can be drawn with either.
	bool same_meshes(const LayerDrawing &other) const {
		return std::ranges::equal(meshes, other.meshes, &MeshAppearance::same_meshes) &&
				std::ranges::equal(lod_meshes, other.lod_meshes, &MeshAppearance::same_meshes);
	}

	/// Returns the finest mesh of each entry; null for an entry that draws nothing.
	std::vector<godot::Ref<godot::Mesh>> finest_meshes() const {
		std::vector<godot::Ref<godot::Mesh>> result;
		std::ranges::transform(meshes, std::back_inserter(result), &MeshAppearance::mesh);
		return result;
	}

	friend bool operator==(const LayerDrawing &, const LayerDrawing &) = default;
};

/// The collision shape of an instance. Scenes store these values, so they must not change.
enum class BodyShape : std::uint8_t { none, capsule, cylinder, box, convex, model };

/// The static bodies of a layer's instances.
struct LayerCollision {
	BodyShape shape = BodyShape::none;
	/// The distance in meters. An instance has a body if a viewer or a moving body is nearer.
	double distance = 40.0;
	std::int64_t layer = 1; ///< The bit mask CollisionObject3D.collision_layer.
	std::int64_t mask = 1;
	double friction = 1.0; ///< The friction. A negative value means a rough PhysicsMaterial.
	double bounce = 0.0;   ///< The bounce. A negative value means an absorbent PhysicsMaterial.
	/// True if navigation meshes are baked around colliding instances.
	bool affects_navigation = true;
	/// The shapes of each entry's model, if `shape` is `model`.
	std::vector<std::vector<BodyPart>> parts;

	friend bool operator==(const LayerCollision &, const LayerCollision &) = default;
};

/// The scene that replaces a layer's meshes near viewers and moving bodies.
struct LayerScene {
	godot::Ref<godot::PackedScene> scene; ///< The scene; null if there is none.
	/// The distance in meters. A scene replaces a mesh if a viewer or a moving body is nearer. 0
	/// disables scenes.
	double distance = 20.0;

	friend bool operator==(const LayerScene &, const LayerScene &) = default;
};

/// Settings for the interaction of a game with instances. None of them affects placement.
struct LayerGameplay {
	/// The radius, in meters at scale 1, of the cylinder that represents an instance.
	double instance_radius = 0.5;
	double instance_height = 2.0;
	double regrowth_time = 0.0; ///< The time in seconds after which a removed instance grows again; 0 for never.
	LayerCollision collision;
	LayerScene scene;

	friend bool operator==(const LayerGameplay &, const LayerGameplay &) = default;
};

/// The rows in which a layer's instances are placed.
struct LayerRows {
	std::string group; ///< The group of the paths. If it is empty, the rows have no points.
	RowSettings settings;

	friend bool operator==(const LayerRows &, const LayerRows &) = default;
};

/// All settings of a ScatterLayer at one moment. The stream, the display, the workers, queries, and
/// the rings of bodies and scenes use the snapshot instead of the layer. It never changes once it
/// is shared, so the layer may be edited or freed while the snapshot is in use.
///
/// Worker threads may read only `settings` and `drawing.mesh_reach`. The engine's resources belong
/// to the main thread, which must also be the last to release a snapshot.
struct LayerSnapshot {
	/// The placement settings; never null. ScatterLayer creates them without neighbors and shapes,
	/// which the node adds later.
	SharedLayer settings;
	StreamLayer range;
	LayerDrawing drawing;
	LodSettings lod;
	CellSettings cells;
	LayerGameplay gameplay;
	std::optional<LayerRows> rows; ///< Empty if the layer is not in rows. The node adds LayerSettings::rows.
	LayerLinks links;              ///< The layer's name, and its references to other layers by name.
	/// The name of the property that each of settings->rules.fields was created from.
	std::vector<std::string> field_names;
	std::vector<std::string> density_rule_names; ///< The names of settings->rules.density_rules.

	/// Compares `settings` by pointer.
	friend bool operator==(const LayerSnapshot &, const LayerSnapshot &) = default;
};

/// A shared snapshot. Null for a layer that is not displayed, because its entry in the list is
/// empty or it was never valid.
using SharedSnapshot = std::shared_ptr<const LayerSnapshot>;

/// Returns the settings of a layer that queries need. For null, returns a layer that queries skip.
QueryLayer query_layer(const LayerSnapshot *layer);

} // namespace thicket
