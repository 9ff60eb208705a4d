#pragma once

#include "core/drawing/cell_choice.hpp"
#include "core/drawing/lod.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/layer_links.hpp"
#include "core/query/instance_query.hpp"
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
#include <string>
#include <vector>

namespace thicket {

/// How a mesh casts its shadow while it is drawn.
struct MeshShadow {
	godot::Ref<godot::Mesh> mesh; ///< Casts the shadow in place of the drawn mesh. Null if the drawn mesh does.
	std::int64_t setting = -1;    ///< GeometryInstance3D.ShadowCastingSetting, or one of these:

	static constexpr std::int64_t as_layer = -1;
	static constexpr std::int64_t as_layer_unless_on =
			-2; ///< Casts no shadow if the layer's setting is "on", its default.

	/// The effective setting for a layer with `layer_setting`.
	std::int64_t setting_in(std::int64_t layer_setting) const {
		constexpr std::int64_t off = 0;
		constexpr std::int64_t on = 1;
		const bool left_out = setting == as_layer_unless_on && layer_setting == on;
		return left_out ? off : setting < 0 ? layer_setting : setting;
	}

	friend bool operator==(const MeshShadow &, const MeshShadow &) = default;
};

/// A mesh as it is drawn.
struct MeshLook {
	godot::Ref<godot::Mesh> mesh;
	MeshShadow shadow;
	LodLook look;
	bool fades = false; ///< True if all its materials can fade: they include scatter_fade.gdshaderinc.

	/// True if both have the same mesh and shadow mesh. The number of instances and the parameters that they are drawn
	/// with may differ.
	bool same_meshes(const MeshLook &other) const { return mesh == other.mesh && shadow == other.shadow; }

	friend bool operator==(const MeshLook &, const MeshLook &) = default;
};

/// The meshes that are drawn for the instances of a layer, and how the renderer draws them. Enumeration values are the engine's.
struct LayerDrawing {
	std::vector<MeshLook> meshes; ///< One for each mesh of the layer. A null mesh draws nothing.

	/// One row per LOD distance, with an entry for each of the meshes. A null mesh means that the next finer LOD is
	/// kept.
	std::vector<MeshLook> lod_meshes;

	/// The material IDs and vertex counts of the surfaces of all meshes that can fade. They differ if a resource has
	/// changed, although it is the same object.
	std::vector<std::uint64_t> surfaces;

	/// The box of each mesh when the snapshot was created. A different box means that the mesh has changed, even if it
	/// is the same resource.
	std::vector<godot::AABB> boxes;

	/// The distance in meters, at scale 1, from the origin of each mesh to its farthest corner, over all its LODs.
	/// Enlarged as much as thinning may enlarge instances.
	std::vector<float> mesh_reach;

	double draw_cell_size = 0.0; ///< Meters; 0 for a size that fits the models. LayerSnapshot::cells has the result.

	godot::Ref<godot::Material> material_override; ///< Null to use the materials of the meshes.
	std::int64_t cast_shadow = 1;
	std::int64_t gi_mode = 1;
	std::int64_t render_layers = 1;
	double lod_bias = 1.0;
	double extra_cull_margin = 0.0; ///< Meters. In a snapshot, sway_reach of the materials is added to the property.

	/// True if anything is drawn for the mesh at this index.
	bool draws(std::size_t mesh) const { return mesh < meshes.size() && meshes[mesh].mesh.is_valid(); }
	float reach_of(std::size_t mesh) const { return mesh < mesh_reach.size() ? mesh_reach[mesh] : 0.0F; }

	/// True if both draw the same meshes, so that a tile of one can replace a tile of the other.
	bool same_meshes(const LayerDrawing &other) const {
		return std::ranges::equal(meshes, other.meshes, &MeshLook::same_meshes) &&
				std::ranges::equal(lod_meshes, other.lod_meshes, &MeshLook::same_meshes);
	}

	/// The finest mesh of each model. Null for a model that draws nothing.
	std::vector<godot::Ref<godot::Mesh>> finest_meshes() const {
		std::vector<godot::Ref<godot::Mesh>> result;
		std::ranges::transform(meshes, std::back_inserter(result), &MeshLook::mesh);
		return result;
	}

	friend bool operator==(const LayerDrawing &, const LayerDrawing &) = default;
};

/// The shape of a body. Scenes store these values.
enum class BodyShape : std::uint8_t { none, capsule, cylinder, box, convex, model };

/// The static bodies of a layer's instances.
struct LayerCollision {
	BodyShape shape = BodyShape::none;
	double distance = 40.0; ///< Meters. An instance has a body if a viewer or moving body is nearer than this.
	std::int64_t layer = 1; ///< Physics layers, in the engine's terms.
	std::int64_t mask = 1;
	double friction = 1.0;                    ///< Negative for a rough material, as in StaticBody3D.
	double bounce = 0.0;                      ///< Negative for an absorbent material.
	bool affects_navigation = true;           ///< Navigation meshes are baked around colliding instances.
	std::vector<std::vector<BodyPart>> parts; ///< The shapes of each mesh's model, if `shape` is `model`.

	friend bool operator==(const LayerCollision &, const LayerCollision &) = default;
};

/// The scenes that replace a layer's meshes near viewers.
struct LayerScene {
	godot::Ref<godot::PackedScene> scene; ///< Null if there is none.
	double distance = 20.0; ///< Meters. A scene replaces the mesh if a viewer or moving body is nearer; 0 for never.

	friend bool operator==(const LayerScene &, const LayerScene &) = default;
};

/// The settings for how a game interacts with instances. None of them affects where instances are placed.
struct LayerGameplay {
	double instance_radius = 0.5; ///< Meters at scale 1. Radius of the cylinder that represents an instance.
	double instance_height = 2.0;
	double regrowth_time = 0.0; ///< Seconds; 0 for never.
	LayerCollision collision;
	LayerScene scene;

	friend bool operator==(const LayerGameplay &, const LayerGameplay &) = default;
};

/// All settings of a ScatterLayer at one moment. The stream, the display, the workers, the rings of bodies and scenes,
/// and queries all use it. A snapshot never changes once it is shared, so the layer may be edited or freed in the
/// meantime.
///
/// Worker threads read `settings` and `drawing.mesh_reach`. All resources of the engine belong to the main thread,
/// which must also be the last to release a snapshot.
struct LayerSnapshot {
	SharedLayer
			settings; ///< Never null. ScatterLayer creates it without neighbors and shapes, which the node adds later.
	StreamLayer range;
	LayerDrawing drawing;
	LodSettings lod;
	CellSettings cells;
	LayerGameplay gameplay;
	LayerLinks links;                     ///< The layer's name, and its references to other layers by name.
	std::vector<std::string> field_names; ///< The property behind each of settings->rules.fields.

	/// Settings are equal only if they are the same object.
	friend bool operator==(const LayerSnapshot &, const LayerSnapshot &) = default;
};

/// Null for a layer that is not displayed: an empty entry of the list, or a layer that was never valid.
using SharedSnapshot = std::shared_ptr<const LayerSnapshot>;

/// The settings of a layer that queries need. For null, returns a layer that queries skip.
QueryLayer query_layer(const LayerSnapshot *layer);

} // namespace thicket
