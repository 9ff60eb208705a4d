#include "nodes/scatter/scatter_problems.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/layer/layer_materials.hpp"

#include <godot_cpp/classes/rendering_server.hpp>
#include <godot_cpp/core/object.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// Adds a problem for each biome in an expression that the node does not have, and for textures of a
/// ground without textures.
void add_input_problems(ScatterLayer &layer, const String &p_prefix, bool lacks_textures,
		const ScatterBiomeMap *p_biomes, PackedStringArray &r_problems) {
	std::set<std::string> reported_inputs;
	for (const WorldInput &input : layer.world_inputs()) {
		const String text = String::utf8(text_of(input).c_str());
		const bool is_unknown = input.kind == WorldInputKind::biome &&
				(p_biomes == nullptr || std::ranges::count(p_biomes->weights_for(input), 1.0F) == 0);
		const bool has_no_textures = input.kind == WorldInputKind::texture && lacks_textures;
		if ((!is_unknown && !has_no_textures) || !reported_inputs.insert(text_of(input)).second) {
			continue;
		}
		if (is_unknown) {
			r_problems.push_back(p_prefix +
					vformat("%s in an expression is 0 everywhere: TerrainScatter3D.biomes has no such biome. Use the "
							"resource_name of a biome, or its index in the list.",
							text));
		} else {
			r_problems.push_back(p_prefix +
					vformat("%s in an expression is 1 everywhere: the ground has no textures. Use another input.",
							text));
		}
	}
}

/// Adds the problems of one layer that do not depend on other layers.
void add_problems_of(ScatterLayer &layer, const String &p_prefix, const Ref<ScatterGround> &p_ground, bool has_water,
		const ScatterBiomeMap *p_biomes, PackedStringArray &r_problems) {
	for (const String &problem : layer.problems()) {
		r_problems.push_back(p_prefix + problem);
	}
	const bool is_usable = p_ground.is_valid() && p_ground->problem().is_empty();
	if (layer.get_ground_textures().size() > 0 && is_usable && !p_ground->has_textures()) {
		r_problems.push_back(p_prefix +
				String("ScatterLayer.ground_textures has no effect: the ground has no textures. "
					   "Clear ground_textures."));
	}
	add_input_problems(layer, p_prefix, is_usable && !p_ground->has_textures(), p_biomes, r_problems);
	if (layer.is_on_surfaces() && !layer.has_surface_layers() && is_usable && !p_ground->has_surfaces()) {
		r_problems.push_back(p_prefix +
				String("nothing is placed: on_surfaces requires the triangles of the ground, and a ") +
				p_ground->get_class() +
				String(" has none here. Use meshes, a heightmap, Terrain3D or HTerrain, or disable on_surfaces."));
	}
	const bool on_planet = is_usable && p_ground->planet().exists();
	if (on_planet && !layer.is_on_surfaces()) {
		r_problems.push_back(p_prefix +
				String("grows only on the top of the planet, as seen along world y: without on_surfaces, planet_radius "
					   "has no effect. Enable ScatterLayer.on_surfaces."));
	}
	const double limit = max_view_tiles_in_space * layer.range().tile_size;
	if (on_planet && layer.is_on_surfaces() && layer.range().view_distance > limit) {
		r_problems.push_back(p_prefix +
				vformat("view_distance is limited to %.1f m (16 x tile_size) on a planet, got %.1f m. Increase "
						"tile_size or lower view_distance.",
						limit, layer.range().view_distance));
	}
	if (layer.needs_water() && !has_water) {
		r_problems.push_back(p_prefix +
				String("nothing is placed: min_water_depth requires water, and there is none. Set "
					   "TerrainScatter3D.water_enabled."));
	}
}

/// Tolerances for the rounding errors of a chain of parents.
constexpr double basis_tolerance = 1e-4;
constexpr double position_tolerance = 1e-3;          // Meters.
constexpr double relative_position_tolerance = 1e-6; // Relative to the offset.

bool is_identity(const glm::dmat3 &basis) {
	bool is_same = true;
	for (int column = 0; column < 3; ++column) {
		for (int row = 0; row < 3; ++row) {
			is_same = is_same && std::abs(basis[column][row] - (column == row ? 1.0 : 0.0)) <= basis_tolerance;
		}
	}
	return is_same;
}

} // namespace

bool is_displaced(const Node3D &node, glm::dvec3 offset) {
	if (!node.is_inside_tree()) {
		return false;
	}
	const Transform3D transform = node.get_global_transform();
	const glm::dvec3 displacement = to_core(transform.origin) + offset;
	const double tolerance = position_tolerance + relative_position_tolerance * glm::length(offset);
	// A game that recenters its world may move this node along with it, which is not a
	// displacement.
	const bool is_moved =
			glm::length(to_core(transform.origin)) > position_tolerance && glm::length(displacement) > tolerance;
	return is_moved || !is_identity(to_core(transform.basis));
}

void add_transform_problem(const Node3D &node, glm::dvec3 offset, PackedStringArray &r_problems) {
	if (!is_displaced(node, offset)) {
		return;
	}
	const Transform3D transform = node.get_global_transform();
	const bool is_moved_only = is_identity(to_core(transform.basis));
	const String value = is_moved_only ? vformat("is moved to %s", transform.origin) : String("is rotated or scaled");
	r_problems.push_back(vformat("TerrainScatter3D.global_transform %s and has no effect: instances keep their "
								 "positions in the world, while "
								 "the node's ScatterRegion3Ds move with it. Reset the transforms of the node and "
								 "its parents; to shift the "
								 "world, set TerrainScatter3D.world_offset.",
			value));
}

void add_local_problems(const Node3D &node, const Ref<ScatterGround> &p_ground, PackedStringArray &r_problems) {
	const glm::dmat3 axes = node.is_inside_tree() ? to_core(node.get_global_transform().basis) : glm::dmat3(1.0);
	if (!is_identity(WorldFrame::of_local_space(axes, glm::dvec3(0.0)).rotation * axes)) {
		r_problems.push_back(
				"TerrainScatter3D.global_transform is scaled, skewed or mirrored. With local_coords, "
				"instances only move and rotate with the node. Reset the scales of the node and its parents.");
	}
	if (p_ground.is_valid() && !p_ground->moves_with_host()) {
		r_problems.push_back(String("TerrainScatter3D.ground: a ") + p_ground->get_class() +
				String(" does not move with the node, as local_coords requires. Use a ScatterGroundMeshes with the "
					   "meshes or bodies of the moving object, or disable local_coords."));
	}
}

void add_viewer_problems(
		const Node3D &node, const ViewerSettings &viewers, const Status &viewer_status, PackedStringArray &r_problems) {
	if (!node.is_inside_tree()) {
		return;
	}
	for (int64_t index = 0; index < viewers.paths.size(); ++index) {
		const Node3D *viewer = Object::cast_to<Node3D>(node.get_node_or_null(viewers.paths[index]));
		const String name = "Viewer " + String::num_int64(index);
		if (viewer == nullptr) {
			r_problems.push_back(name + String(" is not a Node3D in this scene. Change or remove its path."));
		} else if (!has_position(*viewer)) {
			r_problems.push_back(
					name + String(" has a position that is not finite, so no tiles are generated around it. Move it."));
		}
	}
	if (viewers.paths.is_empty() && active_cameras(node).empty()) {
		r_problems.push_back(
				"No viewer: TerrainScatter3D.viewers is empty and the viewport has no current Camera3D, so "
				"no tiles are generated. Make a Camera3D current, or list nodes in viewers.");
	}
	if (!viewer_status.ok()) {
		r_problems.push_back(
				sentence("TerrainScatter3D", viewer_status) + String(". No tiles are generated around this viewer."));
	}
}

String problem_of_ground(const Ref<ScatterGround> &p_ground) {
	if (p_ground.is_null()) {
		return "No ground: set TerrainScatter3D.ground to a ScatterGround to display anything.";
	}
	const String export_problem = p_ground->export_problem();
	return export_problem.is_empty() ? p_ground->problem() : export_problem;
}

void add_ground_problems(const Ref<ScatterGround> &p_ground, PackedStringArray &r_problems) {
	const String problem = problem_of_ground(p_ground);
	const String sentence = problem.is_empty() ? p_ground->remark() : problem;
	if (!sentence.is_empty()) {
		r_problems.push_back(sentence);
	}
}

void add_layer_problems(const TypedArray<ScatterLayer> &p_layers, const Ref<ScatterGround> &p_ground, bool has_water,
		const ScatterBiomeMap *p_biomes, PackedStringArray &r_problems) {
	if (p_layers.is_empty()) {
		r_problems.push_back("No layers: add a ScatterLayer to TerrainScatter3D.layers.");
	}
	std::vector<std::optional<LayerLinks>> links;
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		const Ref<ScatterLayer> layer = p_layers[index];
		links.push_back(layer.is_valid() ? std::optional(layer->links()) : std::nullopt);
	}
	std::vector<const LayerLinks *> link_pointers;
	for (const std::optional<LayerLinks> &layer : links) {
		link_pointers.push_back(layer ? &*layer : nullptr);
	}
	std::set<int64_t> ids;
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		const String prefix = "Layer " + String::num_int64(index) + ": ";
		const Ref<ScatterLayer> layer = p_layers[index];
		if (layer.is_null()) {
			r_problems.push_back(prefix +
					String("the entry is empty, so it displays nothing. Assign a ScatterLayer, or remove the entry."));
			continue;
		}
		add_problems_of(*layer.ptr(), prefix, p_ground, has_water, p_biomes, r_problems);
		for (const std::string &problem : name_problems(link_pointers, static_cast<std::size_t>(index))) {
			r_problems.push_back(prefix + String::utf8(problem.c_str()));
		}
		const int64_t id = layer->own_id();
		if (!ids.insert(id >= 0 ? id : index).second) {
			r_problems.push_back(prefix +
					String("has the layer_id of another layer: both use the same random numbers and "
						   "IDs. Set one of them to -1 to assign a new ID."));
		}
	}
}

void add_uniform_problem(
		const TileDisplay &display, std::span<const SharedSnapshot> layers, PackedStringArray &r_problems) {
	// The number of multimeshes that the uniform buffer of 64 KiB has room for. Each takes 16
	// slots.
	constexpr std::uint64_t spare_multimeshes = 256;
	if (String(RenderingServer::get_singleton()->call("get_current_rendering_method")) != String("gl_compatibility")) {
		return;
	}
	std::uint64_t multimeshes = 0;
	for (std::uint32_t layer = 0; layer < layers.size(); ++layer) {
		const SharedSnapshot &snapshot = layers[layer];
		if (snapshot == nullptr || !use_instance_uniforms(materials_of(snapshot->drawing))) {
			continue;
		}
		for (const glm::ivec2 &tile : display.tiles(layer)) {
			const DisplayedTile *displayed_tile = display.find(layer, tile);
			multimeshes += displayed_tile != nullptr ? displayed_tile->multimesh_count() : 0;
		}
	}
	if (multimeshes > spare_multimeshes) {
		r_problems.push_back(vformat(
				"%d multimeshes have shaders with instance uniforms, but the Compatibility renderer supports only %d: "
				"the others use default values. Increase ScatterLayer.tile_size, lower "
				"ScatterLayer.view_distance, or use shaders without instance uniforms.",
				static_cast<int64_t>(multimeshes), static_cast<int64_t>(spare_multimeshes)));
	}
}

PackedStringArray stripped_problems(
		const TypedArray<ScatterLayer> &p_layers, const Ref<ScatterGround> &p_ground, const ScatterBiomeMap *biomes) {
	PackedStringArray result;
	const auto add = [&result](const String &p_problem) {
		if (!p_problem.is_empty()) {
			result.push_back(p_problem);
		}
	};
	add(p_ground.is_valid() ? p_ground->export_problem() : String());
	add(biomes != nullptr ? biomes->stripped_problem() : String());
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		if (const Ref<ScatterLayer> layer = p_layers[index]; layer.is_valid()) {
			layer->add_stripped_problems(result);
		}
	}
	return result;
}

} // namespace thicket
