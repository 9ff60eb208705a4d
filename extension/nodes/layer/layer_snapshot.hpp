#pragma once

#include "core/placement/cell_choice.hpp"
#include "core/placement/lod.hpp"
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

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace thicket {

/// What casts the shadow of a mesh while that is drawn.
struct MeshShadow {
	godot::Ref<godot::Mesh> mesh; ///< In place of the mesh that is drawn; null for that itself.
	std::int64_t setting = -1;    ///< GeometryInstance3D.ShadowCastingSetting, or one of these:

	static constexpr std::int64_t as_layer = -1;
	static constexpr std::int64_t as_layer_unless_on =
			-2; ///< None where the layer says no more than "on", its default.

	/// The setting for a layer with this one.
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
	godot::Ref<godot::Mesh> mesh; ///< Never null.
	MeshShadow shadow;
	LodLook look;
	bool fades = false; ///< All its materials can: they include scatter_fade.gdshaderinc.
};

/// What is drawn for the instances of a layer, and how the renderer draws it. The numbers of enumerations are the engine's.
struct LayerDrawing {
	std::vector<godot::Ref<godot::Mesh>> meshes; ///< Nothing is drawn for a null entry.

	/// A row of entries, one for each of the meshes, for each LOD distance. A null entry means the next finer mesh.
	std::vector<godot::Ref<godot::Mesh>> lod_meshes;

	std::vector<MeshShadow> shadows;     ///< Of each of the meshes,
	std::vector<MeshShadow> lod_shadows; ///< and of the lod_meshes that are not null.

	std::vector<LodLook> looks;     ///< Of each of the meshes,
	std::vector<LodLook> lod_looks; ///< and of the lod_meshes that are not null.

	std::vector<bool> fades;     ///< Whether all materials of each of the meshes can fade,
	std::vector<bool> lod_fades; ///< and of each of the lod_meshes.

	/// What is known of the surfaces of all that can fade: others mean that the resources are the same and have changed.
	std::vector<std::uint64_t> surfaces;

	/// The box of each of the meshes when the snapshot was made: another box means another mesh, though the resource is the same.
	std::vector<godot::AABB> boxes;

	/// Meters at scale 1 from the origin of each mesh to its farthest corner, whichever of its LODs is drawn, enlarged as much as
	/// thinning may enlarge it.
	std::vector<float> mesh_reach;

	double draw_cell_size = 0.0; ///< Meters; 0 for what fits the models. LayerSnapshot::cells has what follows from it.

	godot::Ref<godot::Material> material_override; ///< Null for the meshes' own.
	std::int64_t cast_shadow = 1;
	std::int64_t gi_mode = 1;
	std::int64_t render_layers = 1;
	double lod_bias = 1.0;
	double extra_cull_margin = 0.0; ///< Meters; in a snapshot, sway_reach of the materials is added to the property.
	double visibility_range_begin = 0.0;
	double visibility_range_begin_margin = 0.0;
	double visibility_range_end = 0.0;
	double visibility_range_end_margin = 0.0;
	std::int64_t visibility_range_fade_mode = 0;

	/// True if anything is drawn for the mesh of this index.
	bool draws(std::size_t mesh) const { return mesh < meshes.size() && meshes[mesh].is_valid(); }
	float reach_of(std::size_t mesh) const { return mesh < mesh_reach.size() ? mesh_reach[mesh] : 0.0F; }

	/// True if the renderer is given the same meshes: a tile of the one may stand for a tile of the other.
	bool same_meshes(const LayerDrawing &other) const {
		return meshes == other.meshes && lod_meshes == other.lod_meshes && shadows == other.shadows &&
				lod_shadows == other.lod_shadows;
	}

	friend bool operator==(const LayerDrawing &, const LayerDrawing &) = default;
};

/// What a body is made of. The values are those that scenes store.
enum class BodyShape : std::uint8_t { none, capsule, cylinder, box, convex, model };

/// The static bodies of a layer's instances.
struct LayerCollision {
	BodyShape shape = BodyShape::none;
	double distance = 40.0; ///< Meters to the nearest viewer or moving body within which bodies stand.
	std::int64_t layer = 1; ///< Physics layers, as the engine names them.
	std::int64_t mask = 1;
	double friction = 1.0;                    ///< Negative for a rough material, as StaticBody3D hands it over.
	double bounce = 0.0;                      ///< Negative for one that absorbs.
	bool affects_navigation = true;           ///< Navigation meshes are baked around what collides.
	std::vector<std::vector<BodyPart>> parts; ///< Of the model of each of the meshes, if that is the shape.

	friend bool operator==(const LayerCollision &, const LayerCollision &) = default;
};

/// The scenes that replace a layer's meshes near viewers.
struct LayerScene {
	godot::Ref<godot::PackedScene> scene; ///< Null for none.
	double distance = 20.0; ///< Meters to the nearest viewer or moving body within which scenes stand; 0 for never.

	friend bool operator==(const LayerScene &, const LayerScene &) = default;
};

/// What an instance is to a game. None of it decides where instances stand.
struct LayerGameplay {
	double instance_radius = 0.5; ///< Meters at scale 1, of the cylinder that stands for an instance.
	double instance_height = 2.0;
	double regrowth_time = 0.0; ///< Seconds; 0 for never.
	LayerCollision collision;
	LayerScene scene;

	friend bool operator==(const LayerGameplay &, const LayerGameplay &) = default;
};

/// All that a ScatterLayer says, at one moment, for everybody who works with it: the stream, the display, the workers, the rings of
/// bodies and scenes, and queries. Nobody changes it once it is shared, so the layer may be edited, and may go, meanwhile.
///
/// Worker threads read `settings` and `drawing.mesh_reach`. Everything that is a resource of the engine belongs to the main thread, which
/// also has to let go of a snapshot last.
struct LayerSnapshot {
	SharedLayer
			settings; ///< Never null. ScatterLayer makes it without neighbors and shapes: those are added by the node.
	StreamLayer range;
	LayerDrawing drawing;
	LodSettings lod;
	CellSettings cells;
	LayerGameplay gameplay;
	LayerLinks links;                     ///< Its name, and what it says of other layers by name.
	std::vector<std::string> field_names; ///< The property behind each of settings->rules.fields.

	/// Settings count as equal only if they are the same object.
	friend bool operator==(const LayerSnapshot &, const LayerSnapshot &) = default;
};

/// Null for a layer of which nothing is shown: an empty entry of the list, or one that was never valid.
using SharedSnapshot = std::shared_ptr<const LayerSnapshot>;

/// What queries need of a layer. Null gives one that is not wanted.
QueryLayer query_layer(const LayerSnapshot *layer);

} // namespace thicket
