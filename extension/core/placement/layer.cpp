#include "core/placement/layer.hpp"

#include "core/base/check.hpp"
#include "core/placement/edge_probes.hpp"
#include "core/placement/layer_graph.hpp"
#include "core/placement/mesh_choice.hpp"
#include "core/placement/mesh_rules.hpp"
#include "core/surface/surface_sampler.hpp"

#include <algorithm>

namespace thicket {

namespace {

/// Limit for the radius of a planet and for the coordinates of its center, in meters.
constexpr double max_planet_extent = 1e7;

Status validate_planet(const LayerSettings &layer) {
	const Planet &planet = layer.planet;
	const auto check_center = [](const char *property, double value) {
		return check_range(property, value, -max_planet_extent, max_planet_extent);
	};
	const Status status = first_failure(check_range("planet_radius", planet.radius, 0.0, max_planet_extent),
			check_center("planet_center.x", planet.center.x), check_center("planet_center.y", planet.center.y),
			check_center("planet_center.z", planet.center.z));
	return status.ok() && planet.exists() && !layer.set.on_surface ? Status{ErrorCode::missing, "on_surface", 0.0}
																   : status;
}

Status validate_mesh_rules(const LayerSettings &layer) {
	const std::size_t meshes = std::max<std::size_t>(layer.mesh_weights.size(), 1);
	if (layer.mesh_rules.size() > meshes) {
		return Status::out_of_range("mesh_rules", layer.mesh_rules.size(), at_most(meshes, "one for each mesh"));
	}
	for (const std::optional<Rules> &rules : layer.mesh_rules) {
		if (!rules.has_value()) {
			continue;
		}
		if (rules->shapes != nullptr || !rules->ground_textures.empty() || !rules->density_rules.empty() ||
				rules->edge_feather != 0.0) {
			return Status::wrong_type(
					"mesh_rules", "Remove shapes, ground textures, density rules and the edge feather");
		}
		if (const Status status = validate(*rules); !status.ok()) {
			return status;
		}
	}
	return {};
}

Status validate_world_sources(const LayerSettings &layer) {
	const std::vector<WorldSource> needed = empty_sources(layer);
	if (needed.size() > max_world_sources) {
		return Status::out_of_range("mesh_density_expressions", needed.size(),
				at_most(max_world_sources, "different biomes, textures, distances and mask channels"),
				"Use fewer of them");
	}
	const auto has_source = [&layer](const WorldSource &source) {
		return source_of(layer.world_sources, source.input) < layer.world_sources.size();
	};
	if (!std::ranges::all_of(needed, has_source)) {
		return {ErrorCode::missing, "world_sources", 0.0};
	}
	const bool uses_texture = std::ranges::any_of(
			needed, [](const WorldSource &source) { return source.input.kind == WorldInputKind::texture; });
	return uses_texture && layer.set.on_surface
			? Status::out_of_range("on_surfaces", 1.0, exactly(0.0, "false, because an expression uses texture()"),
					  "Disable it, because surfaces have no textures, or remove texture() from the expressions")
			: Status();
}

Status validate_alone(const LayerSettings &layer) {
	if (layer.hosted && !layer.set.on_surface) {
		return Status::missing("on_surfaces", "Enable it, because surface_layers requires it");
	}
	if (layer.set.in_rows && layer.set.on_surface) {
		return Status::out_of_range("on_surfaces", 1.0, exactly(0.0, "false, because the layer has rows"),
				"Disable it, because rows need ground as seen from above, or clear rows");
	}
	return first_failure(validate(layer.set), validate(layer.rules), validate(layer.placement),
			validate(layer.instance_data), validate_mesh_weights(layer.mesh_weights), validate_mesh_rules(layer),
			validate_world_sources(layer), validate_planet(layer));
}

} // namespace

Status validate(const LayerSettings &layer) {
	const LayerGraph graph(layer);
	Status status = graph.status();
	for (std::size_t i = graph.nodes().size(); status.ok() && i-- > 0;) {
		status = validate_alone(*graph.nodes()[i].layer);
	}
	return status;
}

bool fills_around(const LayerSettings &layer, const Neighbor &neighbor) {
	return layer.spacing_fills && !layer.set.in_rows && neighbor.curve == nullptr &&
			!distance_in_space(layer, *neighbor.layer);
}

bool fills(const LayerSettings &layer) {
	return std::ranges::any_of(
			layer.neighbors, [&layer](const Neighbor &neighbor) { return fills_around(layer, neighbor); });
}

bool needs_main_thread(const LayerSettings &layer) {
	const auto on_main_thread = [](const SharedDensityRule &rule) {
		return !rule->is_thread_safe();
	};
	const LayerGraph graph(layer);
	return std::ranges::any_of(graph.nodes(), [&](const LayerGraph::Node &node) {
		return std::ranges::any_of(node.layer->rules.density_rules, on_main_thread);
	});
}

bool follows_normals(const LayerSettings &layer) {
	const Placement &placement = layer.placement;
	const InstanceData &data = layer.instance_data;
	return placement.align_to_normal != 0.0 || placement.offset_along_normal != 0.0 || mesh_rules_need_slope(layer) ||
			data.scale.kind == SourceKind::slope || (data.color_is_known() && data.color.kind == SourceKind::slope) ||
			(data.variation_is_known() && data.variation.kind == SourceKind::slope);
}

std::optional<Rotation> row_heading(const LayerSettings &layer, std::uint64_t id) {
	const bool turns = layer.set.in_rows && layer.rows != nullptr && layer.rows->settings().turns_instances;
	return turns ? std::optional(layer.rows->heading(id)) : std::nullopt;
}

SurfaceFaces permitted_faces(const LayerSettings &layer) {
	if (layer.planet.exists()) {
		return SurfaceFaces::all;
	}
	return layer.rules.max_slope_degrees <= 90.0    ? SurfaceFaces::up
			: layer.rules.min_slope_degrees >= 90.0 ? SurfaceFaces::down
													: SurfaceFaces::all;
}

double host_distance(const LayerSettings &layer, double reach) {
	return std::max(sampling_margin(layer.set, host_margins.widest), edge_reach(layer.rules.edge_feather, true)) +
			reach;
}

double reach(const LayerSettings &layer) {
	double farthest = 0.0;
	const LayerGraph graph(layer, fill_chain_cells);
	for (const LayerGraph::Node &node : graph.nodes()) {
		const PointSet &set = node.layer->set;
		const double chain = set.on_surface ? surface_chain_reach * set.radius : 0.0;
		const double edge = edge_reach(node.layer->rules.edge_feather, set.on_surface);
		farthest = std::max(farthest, node.margin + edge + chain);
	}
	return farthest;
}

double points_to_sample(const LayerSettings &layer, double tile_size) {
	double points = 0.0;
	const LayerGraph graph(layer);
	for (const LayerGraph::Node &node : graph.nodes()) {
		const double side = tile_size + 2.0 * node.margin;
		points += point_density(node.layer->set) * side * side;
	}
	return points;
}

} // namespace thicket
