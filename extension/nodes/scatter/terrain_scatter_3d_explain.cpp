// This file explains why a layer has or does not have an instance at a position. It also evaluates
// rules on a grid, for scripts and the editor.

#include "nodes/scatter/terrain_scatter_3d.hpp"

#include "core/base/tile_grid.hpp"
#include "core/explain/planet_samples.hpp"
#include "core/explain/position_grid.hpp"
#include "core/rules/planet_map.hpp"
#include "core/terrain/surface_line.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/explain/layer_explainer.hpp"
#include "nodes/layer/layer_reference.hpp"
#include "nodes/scatter/scatter_problems.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// Replaces the verdict with a negative one that names the rule and the reason.
void reject(const char *rule, const std::string &reason, LayerExplanation &r_explanation) {
	r_explanation.verdict = {false, rule, reason};
}

std::string not_drawn_message(const LayerExplanation &explanation, const std::string &reason) {
	return "Placed " + distance_text(explanation.rules.distance) + ", but not drawn: " + reason;
}

/// Adds a message about each mesh of a layer with several meshes.
void explain_meshes(const Ref<ScatterLayer> &p_layer, LayerExplanation &r_explanation) {
	const PositionExplanation &rules = r_explanation.rules;
	const std::size_t count = rules.has_point ? rules.meshes.size() : 0;
	for (std::size_t mesh = 0; count > 1 && mesh < count; ++mesh) {
		const std::string name = p_layer->mesh_name(mesh).utf8().get_data();
		r_explanation.mesh_messages.push_back(describe_mesh(rules, mesh, name));
	}
}

std::span<const Vector3> span_of(const PackedVector3Array &p_vectors) {
	return {p_vectors.ptr(), static_cast<std::size_t>(p_vectors.size())};
}

/// Returns a function that converts positions of the engine, for values_of.
auto engine_positions(const PackedVector3Array &p_positions) {
	return [&p_positions](const WorldFrame &frame, std::vector<glm::dvec3> &r_positions) {
		std::ranges::transform(span_of(p_positions), std::back_inserter(r_positions),
				[&frame](const Vector3 &p_position) { return to_world(p_position, frame); });
		return Status();
	};
}

bool draws_nothing(const LayerSnapshot &layer) {
	const bool has_mesh = std::ranges::any_of(
			layer.drawing.meshes, [](const MeshAppearance &appearance) { return appearance.mesh.is_valid(); });
	return !has_mesh && layer.gameplay.scene.scene.is_null();
}

} // namespace

/// Returns a message about the problem that keeps all layers from having instances; empty if there
/// is none. Runs scripts.
String TerrainScatter3D::ground_problem() {
	const Ref<ScatterGround> ground = ground_;
	if (const String problem = problem_of_ground(ground); !problem.is_empty()) {
		return problem;
	}
	return ground->is_available() ? String() : String("The ground is temporarily unavailable.");
}

LayerExplainer TerrainScatter3D::layer_explainer() const {
	return {layer_list_.snapshots(), ground_snapshot_, {ground_, get_instance_id()}, {}};
}

/// Adds a game's changes to the explanation: whether the instance was removed, and hand-placed
/// instances nearby.
void TerrainScatter3D::explain_changes(const LayerSnapshot &layer, LayerExplanation &r_explanation) const {
	const Ref<ScatterState> state = get_state();
	if (state.is_null()) {
		return;
	}
	const std::string distance = distance_text(r_explanation.rules.distance);
	if (r_explanation.is_placed && state->state().removed(r_explanation.rules.point.id)) {
		r_explanation.is_placed = false;
		if (r_explanation.verdict.yes) {
			reject("state", "Removed: the state has removed the instance " + distance + ".", r_explanation);
		}
	}
	const double radius = layer.settings->set.radius;
	const glm::dvec2 position(r_explanation.position.x, r_explanation.position.z);
	std::vector<std::uint64_t> ids;
	const Status status =
			state->state().added_in(layer.settings->set.layer, {position - radius, position + radius}, ids);
	if (layer.settings->set.on_surface) {
		// An instance on a different level or on the opposite side of a planet is not nearby.
		std::erase_if(ids, [&](std::uint64_t id) {
			return glm::distance(state->state().added(id)->position, r_explanation.position) > 2.0 * radius;
		});
	}
	if (status.ok() && !ids.empty()) {
		r_explanation.verdict.reason += ids.size() == 1
				? " One was placed by hand nearby."
				: " " + std::to_string(ids.size()) + " were placed by hand nearby.";
	}
}

/// Determines whether an existing instance is currently drawn, and if not, why.
void TerrainScatter3D::explain_drawing(const LayerSnapshot &layer, LayerExplanation &r_explanation) const {
	if (!r_explanation.is_placed) {
		return;
	}
	const auto set_not_drawn = [&](const char *rule, const std::string &reason) {
		if (r_explanation.verdict.yes) {
			reject(rule, not_drawn_message(r_explanation, reason), r_explanation);
		}
	};
	if (!is_inside_tree()) {
		return set_not_drawn("visible", "the node is not in the scene tree.");
	}
	if (!is_visible_in_tree()) {
		return set_not_drawn("visible", "the node is hidden.");
	}
	if (draws_nothing(layer)) {
		return set_not_drawn("meshes", "the layer has no mesh.");
	}
	const glm::dvec2 point = r_explanation.rules.point.position;
	const glm::ivec2 tile = tile_at(layer.range.tile_size, point);
	const glm::dvec3 instance_position(point.x, double{r_explanation.rules.at_point.ground.height}, point.y);
	const std::int32_t slab = layer.range.in_space() ? slab_at(layer.range.tile_size, instance_position.y) : all_slabs;
	const TileSpace space = tile_space(layer.range.tile_size, tile, slab);
	constexpr double infinity = std::numeric_limits<double>::infinity();
	double min_excess = infinity; // The smallest distance beyond any view distance, in meters.
	double nearest_distance = infinity;
	const Sight sight = layer.lod.sight();
	for (const Viewer &viewer : current_viewers().viewers) {
		const double view_distance = layer.range.view_distance * viewer.radius_scale;
		const glm::dvec3 viewer_position(viewer.position.x, viewer.height, viewer.position.y);
		min_excess = std::min(min_excess, std::sqrt(distance_squared(space, viewer_position)) - view_distance);
		nearest_distance = std::min(nearest_distance,
				sight_distance(glm::distance(point, viewer.position), glm::distance(instance_position, viewer_position),
						sight.height_limit(viewer.radius_scale)));
	}
	if (display().find(r_explanation.layer, tile, slab) == nullptr) {
		if (std::isinf(min_excess)) {
			return set_not_drawn("view_distance", "there is no viewer.");
		}
		return min_excess > 0.0 ? set_not_drawn("view_distance",
										  "the nearest viewer is " + distance_text(nearest_distance) +
												  "; the view distance of the layer is " +
												  number_text(layer.range.view_distance, nearest_distance) + " m.")
								: set_not_drawn("loading", "its tile is still being generated.");
	}
	const std::uint32_t rank = thinning_rank(r_explanation.rules.point.rank, r_explanation.rules.at_point.density);
	if (const double fraction = display().drawn_fraction(layer.lod, nearest_distance);
			!thicket::is_placed(rank, fraction)) {
		return set_not_drawn("thinning",
				"only " + number_text(100.0 * fraction) +
						" % of the layer's instances are drawn at this distance (see thin_density, quality and "
						"preview_instances).");
	}
	r_explanation.is_drawn = true;
}

TypedArray<ScatterExplanation> TerrainScatter3D::explain_position(const Vector3 &p_position, const Variant &p_layers) {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	move_world();
	const WorldFrame frame = frame_;
	const TypedArray<ScatterLayer> layers = all_layers();
	TypedArray<ScatterExplanation> result;
	std::vector<std::uint32_t> indices;
	if (const String problem = find_layers(layers, p_layers, indices); !problem.is_empty()) {
		ERR_PRINT(String("TerrainScatter3D.explain_position: ") + problem);
		return result;
	}
	const glm::dvec3 position = to_world(p_position, frame);
	if (!std::isfinite(position.x) || !std::isfinite(position.z)) {
		report("TerrainScatter3D.explain_position",
				{ErrorCode::not_finite, "position", std::isfinite(position.x) ? position.z : position.x});
		return result;
	}
	if (indices.empty()) {
		std::ranges::transform(node_layers_.order(), std::back_inserter(indices),
				[](std::size_t index) { return static_cast<std::uint32_t>(index); });
	}
	const Status status = prepare();
	const std::string problem = gameplay->alive() ? ground_problem().utf8().get_data() : "";
	for (const std::uint32_t index : indices) {
		LayerExplanation explanation;
		explanation.layer = index;
		explanation.position = position;
		const Ref<ScatterLayer> layer = layers[index];
		explanation.layer_name = layer.is_valid() ? String(layer->get_name()).utf8().get_data() : "";
		if (!gameplay->alive()) {
			return TypedArray<ScatterExplanation>(); // A ground script has freed the node.
		}
		if (!problem.empty() || !status.ok()) {
			reject("ground", !problem.empty() ? problem : thicket::describe(status), explanation);
		} else {
			explain_layer(layer, gameplay, explanation);
		}
		append(result, ScatterExplanation::of(std::move(explanation), layer, frame));
	}
	return result;
}

/// Explains one layer at a position. Samples the ground, so scripts may free this node.
void TerrainScatter3D::explain_layer(const Ref<ScatterLayer> &p_layer, const std::shared_ptr<ScatterGameplay> &gameplay,
		LayerExplanation &r_explanation) {
	LayerExplainer explainer = layer_explainer();
	const SharedSnapshot layer =
			r_explanation.layer < explainer.layers.size() ? explainer.layers[r_explanation.layer] : nullptr;
	if (layer == nullptr) {
		return reject("layer",
				p_layer.is_null() ? "The entry in the list of layers is empty." : "The layer's settings are invalid.",
				r_explanation);
	}
	explainer.shape_names = regions_.names_for(all_layers(), r_explanation.layer);
	const glm::dvec3 position = r_explanation.position;
	const Status status = explainer.explain(r_explanation.layer, position, r_explanation);
	if (!status.ok()) {
		const std::string rule_problem = density_rule_problem(*layer->settings, status);
		return reject(rule_problem.empty() ? "layer" : "density_rules",
				rule_problem.empty() ? "The layer cannot be explained: " + thicket::describe(status) + "."
									 : rule_problem,
				r_explanation);
	}
	explain_meshes(p_layer, r_explanation);
	if (gameplay->alive()) {
		explain_changes(*layer, r_explanation);
		explain_drawing(*layer, r_explanation);
	}
}

Vector3 TerrainScatter3D::up_at(const Vector3 &p_position) {
	const Planet planet = this->planet();
	if (!planet.exists()) {
		return {0.0F, 1.0F, 0.0F};
	}
	move_world();
	const glm::dvec3 position = to_world(p_position, frame_);
	return to_engine(frame_.to_engine(position + planet.up_at(position)) - frame_.to_engine(position));
}

PackedFloat64Array TerrainScatter3D::get_planet() {
	const Planet planet = this->planet();
	if (!planet.exists()) {
		return {};
	}
	move_world();
	const glm::dvec3 center = frame_.to_engine(planet.center);
	const std::array numbers{center.x, center.y, center.z, planet.radius};
	return packed<PackedFloat64Array>(std::span<const double>(numbers), [](double number) { return number; });
}

PackedVector3Array TerrainScatter3D::hit_surface(const Vector3 &p_from, const Vector3 &p_to) {
	move_world();
	const std::shared_ptr<const Terrain> terrain = ground_snapshot_;
	const Surface *surface = terrain != nullptr ? terrain->surface() : nullptr;
	if (surface == nullptr) {
		return {};
	}
	const SurfacePosition hit = first_on_line(*surface, to_world(p_from, frame_), to_world(p_to, frame_));
	if (!std::isfinite(hit.position.x)) {
		return {};
	}
	const glm::dvec3 position = frame_.to_engine(hit.position);
	const std::array<glm::dvec3, 2> vectors{position, frame_.to_engine(hit.position + hit.normal) - position};
	return packed<PackedVector3Array>(
			std::span<const glm::dvec3>(vectors), [](const glm::dvec3 &vector) { return to_engine(vector); });
}

/// Returns a number for each position. `p_layer` is null for values of the ground alone. `find`
/// writes the positions. If the call is invalid, prints an error and returns an empty array.
template <class Position, class Find, class Evaluate>
PackedFloat32Array TerrainScatter3D::values_of(
		const char *p_method, const Variant *p_layer, const Find &find, const Evaluate &evaluate) {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	move_world();
	const WorldFrame frame = frame_;
	std::uint32_t layer = 0;
	if (p_layer != nullptr && !find_layer_index(p_method, *p_layer, layer)) {
		return {};
	}
	std::vector<Position> positions;
	std::vector<float> values;
	std::string rule_problem;
	Status status = find(frame, positions);
	if (status.ok()) {
		status = prepare();
	}
	if (status.ok() && gameplay->alive()) {
		const LayerExplainer explainer = layer_explainer();
		const bool is_known = layer < explainer.layers.size() && explainer.layers[layer] != nullptr;
		status = !explainer.ground.is_available() ? Status::missing("ground", "Set TerrainScatter3D.ground")
				: p_layer != nullptr && !is_known ? refused_layer()
												  : evaluate(explainer, layer, positions, values);
		rule_problem = is_known ? density_rule_problem(*explainer.layers[layer]->settings, status) : "";
	}
	report((std::string("TerrainScatter3D.") + p_method).c_str(), status, rule_problem);
	if (!status.ok()) {
		return {};
	}
	return packed<PackedFloat32Array>(std::span<const float>(values), [](float value) { return value; });
}

/// Returns a number for each cell of a grid over a rectangle, row by row; see values_of.
template <class Evaluate>
PackedFloat32Array TerrainScatter3D::map_of(const char *p_method, const Variant *p_layer, const Rect2 &p_rect,
		const Vector2i &p_size, const Evaluate &evaluate) {
	const auto find = [&](const WorldFrame &frame, std::vector<glm::dvec2> &r_positions) {
		return grid_positions(to_world(p_rect, frame), {p_size.x, p_size.y}, r_positions);
	};
	return values_of<glm::dvec2>(p_method, p_layer, find, evaluate);
}

PackedVector3Array TerrainScatter3D::to_planet(const PackedVector3Array &p_positions) {
	const Planet planet = this->planet();
	if (!planet.exists()) {
		return {};
	}
	move_world();
	return packed<PackedVector3Array>(span_of(p_positions),
			[&](const Vector3 &p_position) { return to_engine(to_world(p_position, frame_) - planet.center); });
}

PackedVector3Array TerrainScatter3D::planet_ground(const Vector3 &p_center, const PackedVector2Array &p_positions) {
	move_world();
	const Planet planet = this->planet();
	const std::shared_ptr<const Terrain> terrain = ground_snapshot_;
	const Surface *surface = terrain != nullptr ? terrain->surface() : nullptr;
	if (!planet.exists() || surface == nullptr) {
		return {};
	}
	const PlanetMap map(planet, to_world(p_center, frame_));
	const std::span<const Vector2> positions(p_positions.ptr(), static_cast<std::size_t>(p_positions.size()));
	return packed<PackedVector3Array>(positions, [&](const Vector2 &p_position) {
		return to_engine(frame_.to_engine(planet_ground_toward(*surface, planet, map.direction(to_core(p_position)))));
	});
}

PackedFloat32Array TerrainScatter3D::densities_at(const Variant &p_layer, const PackedVector3Array &p_positions) {
	return values_of<glm::dvec3>("_densities_at", &p_layer, engine_positions(p_positions),
			[](const LayerExplainer &explainer, std::uint32_t layer, std::span<const glm::dvec3> positions,
					std::vector<float> &r_values) { return explainer.densities_at(layer, positions, r_values); });
}

PackedFloat32Array TerrainScatter3D::slopes_at(const PackedVector3Array &p_positions) {
	const Planet planet = this->planet();
	return values_of<glm::dvec3>("_slopes_at", nullptr, engine_positions(p_positions),
			[&planet](const LayerExplainer &explainer, std::uint32_t, std::span<const glm::dvec3> positions,
					std::vector<float> &r_values) { return explainer.slopes_at(planet, positions, r_values); });
}

PackedFloat32Array TerrainScatter3D::get_density_map(
		const Variant &p_layer, const Rect2 &p_rect, const Vector2i &p_size) {
	return map_of("get_density_map", &p_layer, p_rect, p_size,
			[](const LayerExplainer &explainer, std::uint32_t layer, std::span<const glm::dvec2> positions,
					std::vector<float> &r_values) { return explainer.densities(layer, positions, r_values); });
}

PackedFloat32Array TerrainScatter3D::get_slope_map(const Rect2 &p_rect, const Vector2i &p_size) {
	return map_of("get_slope_map", nullptr, p_rect, p_size,
			[](const LayerExplainer &explainer, std::uint32_t, std::span<const glm::dvec2> positions,
					std::vector<float> &r_values) { return explainer.slopes(positions, r_values); });
}

PackedFloat32Array TerrainScatter3D::get_rank_map(const Variant &p_layer, const Rect2 &p_rect, const Vector2i &p_size) {
	return map_of("get_rank_map", &p_layer, p_rect, p_size,
			[](const LayerExplainer &explainer, std::uint32_t layer, std::span<const glm::dvec2> positions,
					std::vector<float> &r_values) { return explainer.ranks(layer, positions, r_values); });
}

} // namespace thicket
